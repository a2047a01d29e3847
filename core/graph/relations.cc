#include "core/graph/relations.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <queue>
#include <unordered_map>
#include <utility>

namespace cairn {

double spread_m(const Eigen::Matrix4d& covariance) {
  constexpr double kLeverM = 5.0;
  return std::sqrt(covariance(0, 0) + covariance(1, 1) + covariance(2, 2) +
                   kLeverM * kLeverM * covariance(3, 3));
}

Eigen::Matrix4d covariance_of(const Eigen::Matrix4d& information) {
  constexpr double kLeast = 1e-4;
  const Eigen::Matrix4d covariance = (information + kLeast * Eigen::Matrix4d::Identity()).inverse();
  return 0.5 * (covariance + covariance.transpose());
}

Eigen::Matrix4d information_of(const Eigen::Matrix4d& covariance) {
  const Eigen::Matrix4d inverse = covariance.llt().solve(Eigen::Matrix4d::Identity());
  return 0.5 * (inverse + inverse.transpose());
}

Eigen::Matrix4d blurred(const Eigen::Matrix4d& information, const Eigen::Matrix4d& more) {
  const Eigen::Matrix4d less =
      (Eigen::Matrix4d::Identity() + information * more).partialPivLu().solve(information);
  return 0.5 * (less + less.transpose());
}

void Ties::add(const Tie& tie) {
  at_[tie.from].push_back(ties_.size());
  at_[tie.to].push_back(ties_.size());
  ties_.push_back(tie);
}

std::vector<Relation> Ties::from(std::size_t from, const std::vector<LevelPose>& places,
                                 double limit_m) const {
  using Step = std::pair<double, std::size_t>;  // Spread and node: ties break by node.
  std::priority_queue<Step, std::vector<Step>, std::greater<>> front;
  std::unordered_map<std::size_t, Relation> best;
  std::unordered_map<std::size_t, bool> final;
  std::vector<Relation> relations;
  best[from] = {from, {}, Eigen::Matrix4d::Zero()};
  front.emplace(0.0, from);
  while (!front.empty()) {
    const std::size_t here = front.top().second;
    front.pop();
    if (std::exchange(final[here], true)) continue;
    relations.push_back(best[here]);
    const Relation at = best[here];
    for (const std::size_t i : at_[here]) {
      const Tie& tie = ties_[i];
      const bool forward = tie.from == here;
      const std::size_t next = forward ? tie.to : tie.from;
      if (final[next]) continue;
      const LevelPose T = between(places[tie.from], places[tie.to]);
      const LevelPose step = forward ? T : inverse(T);
      const Eigen::Matrix4d own = forward ? tie.covariance : inverted(T, tie.covariance);
      Relation reached{next, at.T_from_node * step,
                       compounded(at.T_from_node, at.covariance, step, own)};
      const double spread = spread_m(reached.covariance);
      const auto known = best.find(next);
      if (spread > limit_m || (known != best.end() && spread_m(known->second.covariance) <= spread))
        continue;
      best[next] = reached;
      front.emplace(spread, next);
    }
  }
  return relations;
}

}  // namespace cairn
