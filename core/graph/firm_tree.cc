#include "core/graph/firm_tree.h"

#include <queue>

#include "core/graph/relations.h"

namespace cairn {

FirmTree::FirmTree(const PoseGraph& graph)
    : nodes_(graph.nodes),
      parent_(graph.nodes.size()),
      depth_(graph.nodes.size(), 0),
      sum_(graph.nodes.size(), Eigen::Matrix4d::Zero()) {
  for (const LevelPose& node : nodes_) {
    middle_m_ += Eigen::Vector2d(node.x_m, node.y_m) / static_cast<double>(nodes_.size());
  }
  std::vector<std::vector<std::size_t>> at(nodes_.size());
  for (std::size_t k = 0; k < graph.constraints.size(); ++k) {
    const GraphConstraint& c = graph.constraints[k];
    if (c.robust) continue;
    at[c.from].push_back(k);
    at[c.to].push_back(k);
  }
  std::vector<bool> reached = graph.fixed;
  std::queue<std::size_t> front;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    parent_[i] = i;
    if (reached[i]) front.push(i);
  }
  for (; !front.empty(); front.pop()) {
    const std::size_t here = front.front();
    for (const std::size_t k : at[here]) {
      const GraphConstraint& c = graph.constraints[k];
      const std::size_t next = c.from == here ? c.to : c.from;
      if (reached[next]) continue;
      reached[next] = true;
      parent_[next] = here;
      depth_[next] = depth_[here] + 1;
      sum_[next] = sum_[here] + carried(graph, c);
      front.push(next);
    }
  }
}

Eigen::Matrix4d FirmTree::carried(const PoseGraph& graph, const GraphConstraint& c) const {
  const Eigen::Matrix4d covariance = covariance_of(c.information);
  const LevelPose& from = graph.nodes[c.from];
  const LevelPose to = from * c.T_from_to;  // Where the error of the measurement sits.
  const Eigen::Matrix4d J =
      lever(middle_m_.x() - to.x_m, middle_m_.y() - to.y_m) * turned_axes(from.yaw_rad);
  return J * covariance * J.transpose();
}

std::size_t FirmTree::meeting(std::size_t a, std::size_t b) const {
  while (depth_[a] > depth_[b]) a = parent_[a];
  while (depth_[b] > depth_[a]) b = parent_[b];
  for (; a != b; a = parent_[a], b = parent_[b]) {
    if (depth_[a] == 0) return a;  // Two roots: both are fixed, their sums are zero.
  }
  return a;
}

Eigen::Matrix4d FirmTree::covariance(std::size_t from, std::size_t to) const {
  const Eigen::Matrix4d path = sum_[from] + sum_[to] - 2.0 * sum_[meeting(from, to)];
  const LevelPose& end = nodes_[to];
  const Eigen::Matrix4d J = turned_axes(nodes_[from].yaw_rad).transpose() *
                            lever(end.x_m - middle_m_.x(), end.y_m - middle_m_.y());
  return J * path * J.transpose();
}

}  // namespace cairn
