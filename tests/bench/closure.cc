#include "tests/bench/closure.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "robot_agent/pipeline/submap_frame.h"

namespace cairn::bench {

Status Closure::add(const Submap& submap) {
  SubmapNode node{.id = submap.id,
                  .T_site_submap = level(agent::pose_of(submap.T_site_submap)),
                  .surface = std::make_shared<HeightMap>(submap.surface),
                  .link = std::nullopt};
  const SubmapId previous{submap.id.boot, submap.id.sequence - 1};
  if (submap.link && holds(previous)) {
    const SubmapLink& link = *submap.link;
    const Eigen::Vector4d sigma(link.sigma_xy_mm / 1e3, link.sigma_xy_mm / 1e3,
                                link.sigma_z_mm / 1e3, link.sigma_yaw_1e4rad / 1e4);
    node.link = ChainLink{previous, level(agent::pose_of(link.T_previous_submap)),
                          sigma.cwiseAbs2().asDiagonal()};
  }
  if (Status added = graph_.add_submap(std::move(node)); !added) return added;
  return search();
}

SubmapPose Closure::place(SubmapId id) const { return agent::rounded(upright(*graph_.place(id))); }

std::size_t Closure::loops() const {
  const auto edges = graph_.edges();
  return static_cast<std::size_t>(std::ranges::count_if(edges, [](const SubmapEdge& edge) {
    return edge.kind == EdgeKind::loop && edge.status == EdgeStatus::accepted;
  }));
}

Status Closure::search() {
  constexpr int kSlice = 64;
  while (true) {
    const LoopSearch found = graph_.find_loops(kSlice);
    compared_ += found.registrations;
    if (found.accepted > 0) {
      if (auto moved = graph_.optimise(); !moved) return moved.error();
    }
    if (found.done) return {};
  }
}

}  // namespace cairn::bench
