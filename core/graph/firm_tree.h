#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/graph/pose_graph.h"

namespace cairn {

/// A tree of firm constraints (those that are not robust) from the fixed nodes to all others, and
/// what it tells of how two nodes lie to each other.
class FirmTree {
 public:
  /// Requires: a sound graph.
  explicit FirmTree(const PoseGraph& graph);

  /// Covariance of T_from_to along the tree, along the axes of `from`. Exact to first order: the
  /// error of every step, carried to the site's middle, just adds up.
  [[nodiscard]] Eigen::Matrix4d covariance(std::size_t from, std::size_t to) const;

 private:
  [[nodiscard]] Eigen::Matrix4d carried(const PoseGraph& graph, const GraphConstraint& c) const;
  [[nodiscard]] std::size_t meeting(std::size_t a, std::size_t b) const;

  std::vector<LevelPose> nodes_;
  Eigen::Vector2d middle_m_ = Eigen::Vector2d::Zero();
  std::vector<std::size_t> parent_;  ///< Of a root: itself.
  std::vector<std::size_t> depth_;
  std::vector<Eigen::Matrix4d> sum_;  ///< Of the steps from the root, carried to the middle.
};

}  // namespace cairn
