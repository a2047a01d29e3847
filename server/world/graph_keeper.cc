#include "server/world/graph_keeper.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <cmath>
#include <utility>

#include "server/world/graph_rows.h"
#include "server/world/placing.h"

namespace cairn::server {

namespace asio = boost::asio;

namespace {

ChainLink chain_link(const SubmapId& id, const SubmapLink& link) {
  ChainLink chain;
  chain.previous = {id.boot, id.sequence - 1};
  chain.T_previous_submap = to_level(link.T_previous_submap);
  // A millimetre and a tenth of a milliradian are what the integers resolve.
  const Eigen::Vector4d sigma(std::max<double>(link.sigma_xy_mm, 1.0) / 1000.0,
                              std::max<double>(link.sigma_xy_mm, 1.0) / 1000.0,
                              std::max<double>(link.sigma_z_mm, 1.0) / 1000.0,
                              std::max<double>(link.sigma_yaw_1e4rad, 1.0) / 1e4);
  chain.covariance = sigma.cwiseAbs2().asDiagonal();
  return chain;
}

}  // namespace

GraphKeeper::GraphKeeper(const asio::any_io_executor& executor, Tell tell)
    : strand_(asio::make_strand(executor)), pause_(strand_), tell_(std::move(tell)) {}

void GraphKeeper::take(std::vector<MergedSubmap> merged) {
  if (merged.empty()) return;
  asio::post(strand_, [self = shared_from_this(), merged = std::move(merged)] {
    for (const MergedSubmap& submap : merged) self->add(submap);
    self->schedule();
  });
}

void GraphKeeper::add(const MergedSubmap& submap) {
  SubmapNode node{.id = submap.id,
                  .T_site_submap = to_level(submap.T_site_submap),
                  .surface = submap.surface,
                  .link = std::nullopt};
  const SubmapId previous{submap.id.boot, submap.id.sequence - 1};
  if (submap.link && graph_.place(previous)) node.link = chain_link(submap.id, *submap.link);
  if (Status added = graph_.add_submap(std::move(node)); !added) {
    spdlog::debug("pose graph: submap {} left out: {}", submap.id.sequence, added.error().message);
    return;
  }
  world_[submap.id] = submap.T_site_submap;
}

void GraphKeeper::resume(GraphFindings findings) {
  asio::post(strand_, [self = shared_from_this(), findings = std::move(findings)] {
    FoundLoops found;
    for (const LoopRow& row : findings.loops) found.loops.push_back(to_edge(row));
    for (const TriedRow& row : findings.tried) found.tried.push_back(to_pair(row));
    for (const auto& [id, pose] : findings.moves) found.places.push_back({id, to_level(pose)});
    if (Status restored = self->graph_.restore(found); !restored) {
      spdlog::warn("pose graph: begins anew: {}", restored.error().message);
    }
    for (const LoopRow& row : findings.loops) {
      self->stored_loops_[{row.from, row.to}] = row.status;
    }
    for (const TriedRow& row : findings.tried) self->stored_tries_[{row.a, row.b}] = row.tries;
    self->resumed_ = true;
    self->schedule();
  });
}

void GraphKeeper::schedule() {
  if (scheduled_ || telling_ || !resumed_) return;
  scheduled_ = true;
  asio::post(strand_, [self = shared_from_this()] {
    self->scheduled_ = false;
    self->search();
  });
}

void GraphKeeper::search() {
  const LoopSearch searched = graph_.find_loops(kSlice);
  compared_ += searched.registrations;
  if (searched.accepted > 0) {  // At once: what is known better is searched in smaller windows.
    const auto moved = graph_.optimise();
    if (!moved) spdlog::warn("pose graph: {}", moved.error().message);
    improved_ = true;
  }
  if (!searched.done) return schedule();
  report_in_time();
}

void GraphKeeper::report_in_time() {
  if (compared_ == 0 || pausing_ || telling_) return;
  pausing_ = true;
  pause_.expires_after(kMovePeriod);
  pause_.async_wait([weak = weak_from_this()](const boost::system::error_code& error) {
    const auto self = weak.lock();
    if (error || !self) return;
    self->pausing_ = false;
    self->report_in_time();
  });
  report();
}

void GraphKeeper::report() {
  compared_ = 0;
  GraphFindings findings;
  if (improved_) {
    findings.moves = moves();
    if (!any_worth_moving(findings.moves)) findings.moves.clear();
  }
  add_news(graph_.found(), findings);
  telling_ = true;
  tell_(findings, [self = shared_from_this(), findings](const Status& told) {
    asio::post(self->strand_, [self, findings, told] {
      self->telling_ = false;
      if (told) {
        self->remember(findings);
      } else {
        spdlog::error("pose graph: {}; nothing was moved", told.error().message);
      }
      self->schedule();
    });
  });
}

void GraphKeeper::add_news(const FoundLoops& found, GraphFindings& findings) const {
  for (const SubmapEdge& loop : found.loops) {
    const auto stored = stored_loops_.find({loop.from, loop.to});
    const auto status = static_cast<std::uint8_t>(loop.status);
    if (stored == stored_loops_.end() || stored->second != status) {
      findings.loops.push_back(to_row(loop));
    }
  }
  for (const TriedPair& pair : found.tried) {
    const auto stored = stored_tries_.find({pair.a, pair.b});
    if (stored == stored_tries_.end() || stored->second != pair.tries) {
      findings.tried.push_back(to_row(pair));
    }
  }
}

void GraphKeeper::remember(const GraphFindings& told) {
  for (const auto& [id, pose] : told.moves) world_[id] = pose;
  for (const LoopRow& row : told.loops) stored_loops_[{row.from, row.to}] = row.status;
  for (const TriedRow& row : told.tried) stored_tries_[{row.a, row.b}] = row.tries;
}

std::vector<std::pair<SubmapId, SubmapPose>> GraphKeeper::moves() const {
  std::vector<std::pair<SubmapId, SubmapPose>> moves;
  for (const auto& [id, pose] : world_) {
    const auto place = graph_.place(id);
    if (place && to_submap_pose(*place) != pose) moves.emplace_back(id, to_submap_pose(*place));
  }
  std::ranges::sort(moves, {}, [](const auto& move) { return move.first; });
  return moves;
}

bool GraphKeeper::any_worth_moving(
    const std::vector<std::pair<SubmapId, SubmapPose>>& moves) const {
  return std::ranges::any_of(
      moves, [this](const auto& move) { return worth_moving(world_.at(move.first), move.second); });
}

}  // namespace cairn::server
