#include "core/graph/pose_graph.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "core/graph/firm_tree.h"
#include "core/graph/normal_equations.h"
#include "core/graph/relations.h"

namespace cairn {
namespace {

std::string fault_of(const GraphConstraint& c, std::size_t nodes) {
  if (c.from >= nodes || c.to >= nodes || c.from == c.to) return "does not tie two nodes";
  if (!is_finite(c.T_from_to) || !c.information.allFinite()) return "is not finite";
  const double scale = c.information.cwiseAbs().maxCoeff();
  if ((c.information - c.information.transpose()).cwiseAbs().maxCoeff() > 1e-9 * scale) {
    return "has an information matrix that is not symmetric";
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(c.information, Eigen::EigenvaluesOnly);
  if (eigen.eigenvalues()[0] < -1e-9 * scale) {
    return "has an information matrix that is not positive semidefinite";
  }
  return {};
}

/// Groups of nodes that hang together.
class Groups {
 public:
  explicit Groups(std::size_t nodes) : parent_(nodes) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parent_;
};

/// The first node that firm constraints do not connect to a fixed one.
std::optional<std::size_t> loose_node(const PoseGraph& graph) {
  Groups groups(graph.nodes.size());
  for (const GraphConstraint& c : graph.constraints) {
    if (!c.robust) groups.join(c.from, c.to);
  }
  std::vector<bool> held(graph.nodes.size(), false);
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (graph.fixed[i]) held[groups.find(i)] = true;
  }
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (!held[groups.find(i)]) return i;
  }
  return std::nullopt;
}

Status check(const PoseGraph& graph) {
  if (graph.nodes.size() > kMaxGraphNodes || graph.constraints.size() > kMaxGraphConstraints) {
    return Error{ErrorCode::exhausted, "the pose graph is too large"};
  }
  const auto invalid = [](const std::string& what) {
    return Error{ErrorCode::invalid_argument, what};
  };
  if (graph.fixed.size() != graph.nodes.size()) return invalid("not every node is fixed or free");
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (!is_finite(graph.nodes[i])) return invalid("node " + std::to_string(i) + " is not finite");
  }
  for (std::size_t i = 0; i < graph.constraints.size(); ++i) {
    const std::string fault = fault_of(graph.constraints[i], graph.nodes.size());
    if (!fault.empty()) return invalid("constraint " + std::to_string(i) + " " + fault);
  }
  if (const auto node = loose_node(graph)) {
    return invalid("node " + std::to_string(*node) + " is not tied to a fixed node");
  }
  return {};
}

/// One graph's way to its optimum.
class Optimiser {
 public:
  Optimiser(const PoseGraph& graph, const GraphConfig& config)
      : graph_(graph), config_(config), equations_(graph) {
    answer_.nodes = graph.nodes;
    for (const GraphConstraint& c : graph.constraints) information_.push_back(c.information);
    answer_.chi2_before = chi2(graph.nodes);
  }

  OptimisedGraph run() {
    bool settled = descend(kManySteps);
    if (worst_robust() > config_.robust_limit) {
      answer_.nodes = graph_.nodes;
      settled = graduate();
    }
    answer_.converged = settled;
    answer_.chi2 = chi2(answer_.nodes);
    for (std::size_t k = 0; k < information_.size(); ++k) {
      answer_.switched_off.push_back(graph_.constraints[k].robust && information_[k].isZero(0.0));
    }
    return std::move(answer_);
  }

 private:
  static constexpr int kManySteps = 20;

  [[nodiscard]] double chi2_at(std::size_t k, const std::vector<LevelPose>& nodes,
                               const Eigen::Matrix4d& information) const {
    const GraphConstraint& c = graph_.constraints[k];
    const Eigen::Vector4d r = difference(between(nodes[c.from], nodes[c.to]), c.T_from_to);
    return r.dot(information * r);
  }

  [[nodiscard]] double chi2(const std::vector<LevelPose>& nodes) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < information_.size(); ++k) sum += chi2_at(k, nodes, information_[k]);
    return sum;
  }

  [[nodiscard]] double worst_robust() const {
    double worst = 0.0;
    for (std::size_t k = 0; k < information_.size(); ++k) {
      if (!graph_.constraints[k].robust) continue;
      worst = std::max(worst, chi2_at(k, answer_.nodes, graph_.constraints[k].information));
    }
    return worst;
  }

  /// At first a loop counts as no surer than the chain that it closes: what the chain cannot reach
  /// is out, the rest pulls gently, and right ones, being many and of one mind, win. Then step by
  /// step it counts for more.
  bool graduate() {
    constexpr double kFirst = 4.0;  // The chain may be twice as bad as it believes.
    constexpr double kLast = 1e-6;
    const std::vector<Eigen::Matrix4d> chain = chain_covariances();
    for (double share = kFirst; share > kLast; share /= 2.0) {
      weigh(chain, share);
      descend(2);
    }
    for (bool settled = false; answer_.iterations < config_.max_iterations;) {
      const bool same = !weigh(chain, 0.0);
      if (same && settled) return true;
      settled = descend(kManySteps);
    }
    return false;
  }

  [[nodiscard]] std::vector<Eigen::Matrix4d> chain_covariances() const {
    const FirmTree tree(graph_);
    std::vector<Eigen::Matrix4d> covariances;
    for (const GraphConstraint& c : graph_.constraints) {
      if (c.robust) covariances.push_back(tree.covariance(c.from, c.to));
    }
    return covariances;
  }

  /// Switches robust constraints off and on; returns whether any of them changed over.
  bool weigh(const std::vector<Eigen::Matrix4d>& chain, double share) {
    bool changed = false;
    auto covariance = chain.begin();
    for (std::size_t k = 0; k < information_.size(); ++k) {
      const GraphConstraint& c = graph_.constraints[k];
      if (!c.robust) continue;
      const Eigen::Matrix4d information = blurred(c.information, share * *covariance++);
      const bool was_off = information_[k].isZero(0.0);
      const bool off = chi2_at(k, answer_.nodes, information) > config_.robust_limit;
      information_[k] = off ? Eigen::Matrix4d(Eigen::Matrix4d::Zero()) : information;
      changed = changed || off != was_off;
    }
    return changed;
  }

  /// Up to `steps` steps; whether the last one was small.
  bool descend(int steps) {
    double here = chi2(answer_.nodes);
    for (int i = 0; i < steps && answer_.iterations < config_.max_iterations; ++i) {
      ++answer_.iterations;
      equations_.fill(answer_.nodes, information_);
      const auto largest = step_down(here);
      if (!largest || *largest < config_.small_step) return true;
    }
    return false;
  }

  /// One step that lowers χ², damped as much as that takes; its largest component. Empty when no
  /// step goes down: this is the bottom.
  std::optional<double> step_down(double& here) {
    constexpr double kMaxDamping = 1e9;
    for (double damping = 0.0; damping < kMaxDamping; damping = std::max(10.0 * damping, 1e-4)) {
      const auto step = equations_.solve(damping);
      if (!step) continue;
      std::vector<LevelPose> nodes = moved(*step);
      const double there = chi2(nodes);
      if (!(there <= here)) continue;
      answer_.nodes = std::move(nodes);
      here = there;
      return step->cwiseAbs().maxCoeff();
    }
    return std::nullopt;
  }

  [[nodiscard]] std::vector<LevelPose> moved(const Eigen::VectorXd& step) const {
    std::vector<LevelPose> nodes = answer_.nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (graph_.fixed[i]) continue;
      const auto d = step.segment<4>(static_cast<Eigen::Index>(4 * i));
      nodes[i] = {nodes[i].x_m + d[0], nodes[i].y_m + d[1], nodes[i].z_m + d[2],
                  wrap_angle(nodes[i].yaw_rad + d[3])};
    }
    return nodes;
  }

  const PoseGraph& graph_;
  const GraphConfig& config_;
  NormalEquations4 equations_;
  std::vector<Eigen::Matrix4d> information_;  ///< As it counts now, per constraint.
  OptimisedGraph answer_;
};

}  // namespace

Result<OptimisedGraph> optimise(const PoseGraph& graph, const GraphConfig& config) {
  if (const Status sound = check(graph); !sound) return sound.error();
  return Optimiser(graph, config).run();
}

}  // namespace cairn
