#include "core/graph/normal_equations.h"

#include <algorithm>
#include <cmath>

namespace cairn {

LinearConstraint linearised(const GraphConstraint& constraint, const LevelPose& from,
                            const LevelPose& to) {
  const Eigen::Matrix4d R_t = turned_axes(from.yaw_rad).transpose();
  const double dx = to.x_m - from.x_m;
  const double dy = to.y_m - from.y_m;
  LinearConstraint linear;
  linear.residual = difference(between(from, to), constraint.T_from_to);
  linear.by_to = R_t;
  linear.by_from = -R_t * lever(dx, dy);  // Turning `from` swings what it sees.
  return linear;
}

NormalEquations4::NormalEquations4(const PoseGraph& graph) : graph_(graph) {
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    unknown_.push_back(graph.fixed[i] ? kNone : unknowns_++);
  }
  lay_out();
}

void NormalEquations4::lay_out() {
  rows_.resize(static_cast<std::size_t>(unknowns_));
  for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i].push_back(static_cast<std::int64_t>(i));
  for (const GraphConstraint& c : graph_.constraints) {
    const auto [low, high] = std::minmax(unknown_[c.from], unknown_[c.to]);
    if (low != kNone && low != high) rows_[static_cast<std::size_t>(low)].push_back(high);
  }
  hessian_.resize(4 * unknowns_, 4 * unknowns_);
  Eigen::VectorXi sizes(4 * unknowns_);
  for (std::size_t column = 0; column < rows_.size(); ++column) {
    auto& rows = rows_[column];
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    sizes.segment<4>(static_cast<Eigen::Index>(4 * column))
        .setConstant(static_cast<int>(4 * rows.size()));
  }
  hessian_.reserve(sizes);
  for (std::size_t column = 0; column < rows_.size(); ++column) {
    for (Eigen::Index j = 0; j < 4; ++j) {
      for (const std::int64_t row : rows_[column]) {
        for (Eigen::Index i = 0; i < 4; ++i) {
          hessian_.insert(4 * row + i, static_cast<Eigen::Index>(4 * column) + j) = 0.0;
        }
      }
    }
  }
  hessian_.makeCompressed();
  b_.resize(4 * unknowns_);
  for (std::int64_t i = 0; i < unknowns_; ++i) diagonal_.push_back(slot(i, i));
  for (const GraphConstraint& c : graph_.constraints) {
    const auto [low, high] = std::minmax(unknown_[c.from], unknown_[c.to]);
    mixed_.push_back(low == kNone ? BlockSlot{} : slot(high, low));
  }
  factor_.analyzePattern(hessian_);
}

NormalEquations4::BlockSlot NormalEquations4::slot(std::int64_t row, std::int64_t column) const {
  const auto& rows = rows_[static_cast<std::size_t>(column)];
  const std::int64_t before = std::lower_bound(rows.begin(), rows.end(), row) - rows.begin();
  BlockSlot slot{};
  for (std::size_t j = 0; j < slot.size(); ++j) {
    slot[j] = hessian_.outerIndexPtr()[4 * column + static_cast<std::int64_t>(j)] + 4 * before;
  }
  return slot;
}

void NormalEquations4::add(const BlockSlot& slot, const Eigen::Matrix4d& block) {
  for (Eigen::Index j = 0; j < 4; ++j) {
    Eigen::Map<Eigen::Vector4d>(hessian_.valuePtr() + slot[static_cast<std::size_t>(j)]) +=
        block.col(j);
  }
}

void NormalEquations4::fill(const std::vector<LevelPose>& nodes,
                            const std::vector<Eigen::Matrix4d>& informations) {
  std::fill_n(hessian_.valuePtr(), hessian_.nonZeros(), 0.0);
  b_.setZero();
  for (std::size_t k = 0; k < graph_.constraints.size(); ++k) {
    const Eigen::Matrix4d& information = informations[k];
    if (information.isZero(0.0)) continue;
    const GraphConstraint& c = graph_.constraints[k];
    const LinearConstraint linear = linearised(c, nodes[c.from], nodes[c.to]);
    const std::int64_t from = unknown_[c.from];
    const std::int64_t to = unknown_[c.to];
    const auto add_own = [&](std::int64_t unknown, const Eigen::Matrix4d& J) {
      if (unknown == kNone) return;
      add(diagonal_[static_cast<std::size_t>(unknown)], J.transpose() * information * J);
      b_.segment<4>(4 * unknown) -= J.transpose() * (information * linear.residual);
    };
    add_own(from, linear.by_from);
    add_own(to, linear.by_to);
    if (from == kNone || to == kNone) continue;
    const Eigen::Matrix4d block = linear.by_to.transpose() * information * linear.by_from;
    add(mixed_[k], to > from ? block : Eigen::Matrix4d(block.transpose()));
  }
}

std::optional<Eigen::VectorXd> NormalEquations4::solve(double damping) {
  Eigen::VectorXd step = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(4 * unknown_.size()));
  if (unknowns_ == 0) return step;
  // What nothing measured is held where it is by next to nothing.
  constexpr double kHold = 1e-6;
  Eigen::SparseMatrix<double> damped = hessian_;
  for (const BlockSlot& slot : diagonal_) {
    for (std::size_t j = 0; j < slot.size(); ++j) {
      double& value = damped.valuePtr()[slot[j] + static_cast<std::int64_t>(j)];
      value += damping * value + kHold;
    }
  }
  factor_.factorize(damped);
  if (factor_.info() != Eigen::Success || factor_.vectorD().minCoeff() <= 0.0) return std::nullopt;
  const Eigen::VectorXd solution = factor_.solve(b_);
  if (!solution.allFinite()) return std::nullopt;
  for (std::size_t i = 0; i < unknown_.size(); ++i) {
    if (unknown_[i] != kNone) {
      step.segment<4>(static_cast<Eigen::Index>(4 * i)) = solution.segment<4>(4 * unknown_[i]);
    }
  }
  return step;
}

}  // namespace cairn
