#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/graph/pose_graph.h"

namespace cairn {

/// A constraint's residual and its derivatives by both poses, along the axes of `from`.
struct LinearConstraint {
  Eigen::Vector4d residual;
  Eigen::Matrix4d by_from;
  Eigen::Matrix4d by_to;
};
[[nodiscard]] LinearConstraint linearised(const GraphConstraint& constraint, const LevelPose& from,
                                          const LevelPose& to);

/// The sparse normal equations of a graph: the pattern is laid out once, the numbers are filled in
/// again and again.
class NormalEquations4 {
 public:
  /// Requires: a sound graph; it outlives this.
  explicit NormalEquations4(const PoseGraph& graph);

  /// Linearises around `nodes`; one information matrix per constraint, in place of its own.
  void fill(const std::vector<LevelPose>& nodes, const std::vector<Eigen::Matrix4d>& informations);
  /// The step of all nodes (4 each; fixed ones stay) with `damping` times the diagonal added; empty
  /// when the system is not positive definite.
  [[nodiscard]] std::optional<Eigen::VectorXd> solve(double damping);

 private:
  static constexpr std::int64_t kNone = -1;
  /// Where a constraint's three blocks begin: for each of the four columns the place of the block's
  /// first row among the matrix's values.
  using BlockSlot = std::array<std::int64_t, 4>;

  void lay_out();
  [[nodiscard]] BlockSlot slot(std::int64_t row, std::int64_t column) const;
  void add(const BlockSlot& slot, const Eigen::Matrix4d& block);

  const PoseGraph& graph_;
  std::vector<std::int64_t> unknown_;  ///< Per node its place among those that move; kNone: fixed.
  std::int64_t unknowns_ = 0;
  std::vector<std::vector<std::int64_t>> rows_;  ///< Per block column its block rows, ascending.
  Eigen::SparseMatrix<double> hessian_;          ///< Lower half; diagonal blocks are full.
  Eigen::VectorXd b_;
  std::vector<BlockSlot> diagonal_;  ///< Per unknown.
  std::vector<BlockSlot> mixed_;     ///< Per constraint, where both ends move.
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor_;
};

}  // namespace cairn
