#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/common/result.h"
#include "core/graph/level_pose.h"

namespace cairn {

/// What was measured between two nodes.
struct GraphConstraint {
  std::size_t from = 0;
  std::size_t to = 0;
  LevelPose T_from_to;
  /// [1/m², 1/(m·rad), 1/rad²] Of T_from_to's (x, y, z, yaw), along the axes of `from`. Zero in
  /// directions that were not seen.
  Eigen::Matrix4d information = Eigen::Matrix4d::Identity();
  /// A loop, which may be wrong: switched off when it contradicts the rest.
  bool robust = false;
};

/// Nodes and what ties them together.
struct PoseGraph {
  std::vector<LevelPose> nodes;  ///< [Limit: ≤ kMaxGraphNodes] Where they are believed to be.
  std::vector<bool> fixed;       ///< One per node: it does not move.
  std::vector<GraphConstraint> constraints;  ///< [Limit: ≤ kMaxGraphConstraints]
};

inline constexpr std::size_t kMaxGraphNodes = 100'000;
inline constexpr std::size_t kMaxGraphConstraints = 500'000;

struct GraphConfig {
  int max_iterations = 100;  ///< Steps of all stages together. [Limit: 1 … 10000]
  /// [m], [rad] A step that moves no node further ends the search.
  double small_step = 1e-5;
  /// [-] χ² (4 degrees of freedom) above which a robust constraint is wrong: 0.1 % of the right
  /// ones are.
  double robust_limit = 18.5;
};

/// The poses that fit best, and how well.
struct OptimisedGraph {
  std::vector<LevelPose> nodes;
  std::vector<bool> switched_off;  ///< One per constraint: a loop that contradicts the rest.
  double chi2_before = 0.0;        ///< [-] Of all constraints, before.
  double chi2 = 0.0;               ///< [-] Of those that are not switched off, after.
  int iterations = 0;
  bool converged = false;  ///< Else max_iterations ended it; the poses are the best so far.
};

/// Least squares over all nodes that are not fixed: Levenberg-Marquardt with a sparse Cholesky
/// factorisation. When the robust constraints do not all fit, those beyond the limit are switched
/// off (a truncated quadratic), reached step by step: at first a loop counts only as much as the
/// chain that it closes can tell, so that the answer hangs on neither the start nor a few wrong
/// loops (graduated as in Yang et al., RA-L 2020, but by the chain's covariance). Directions that
/// nothing measured do not move. Deterministic.
/// Errors (invalid_argument, exhausted; nothing is moved): numbers that are not finite,
/// indices out of range, an information matrix that is not symmetric and positive semidefinite, a
/// node that constraints which are not robust do not connect to a fixed one, more than the bounds.
/// Cost: per iteration a factorisation; 5,000 nodes with 10,000 constraints take below a second.
[[nodiscard]] Result<OptimisedGraph> optimise(const PoseGraph& graph, const GraphConfig& config);

}  // namespace cairn
