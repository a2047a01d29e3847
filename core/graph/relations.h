#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/graph/level_pose.h"

namespace cairn {

/// How well a submap's place in another one's frame is known.
struct Relation {
  std::size_t node = 0;
  LevelPose T_from_node;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< Along the axes of `from`.
};

/// A tie that a path may lead along.
struct Tie {
  std::size_t from = 0;
  std::size_t to = 0;
  Eigen::Matrix4d covariance;  ///< Of T_from_to, along the axes of `from`.
};

/// [m] One number for how uncertain a place is: a turn counts by what it moves 5 m away.
[[nodiscard]] double spread_m(const Eigen::Matrix4d& covariance);

/// Covariance behind an information matrix; what it does not tell is known to 100 m or rad.
[[nodiscard]] Eigen::Matrix4d covariance_of(const Eigen::Matrix4d& information);

/// And back. Requires: positive definite.
[[nodiscard]] Eigen::Matrix4d information_of(const Eigen::Matrix4d& covariance);

/// What a measurement tells when it may be off by `more` besides: (information⁻¹ + more)⁻¹, also
/// where the information is singular.
[[nodiscard]] Eigen::Matrix4d blurred(const Eigen::Matrix4d& information,
                                      const Eigen::Matrix4d& more);

/// The ties of a graph, found by node.
class Ties {
 public:
  explicit Ties(std::size_t nodes) : at_(nodes) {}
  void add(const Tie& tie);

  /// The nodes whose place relative to `from` is known better than `limit_m` along the surest path
  /// of ties (Bosse et al. 2004: Dijkstra projection), `from` itself first, the surest next. One
  /// path tells less than all of them, so the answer is never too sure.
  [[nodiscard]] std::vector<Relation> from(std::size_t from, const std::vector<LevelPose>& places,
                                           double limit_m) const;

 private:
  std::vector<Tie> ties_;
  std::vector<std::vector<std::size_t>> at_;
};

}  // namespace cairn
