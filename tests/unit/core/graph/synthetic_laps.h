#pragma once

#include <numbers>
#include <random>
#include <vector>

#include "core/graph/pose_graph.h"

namespace cairn::test {

/// [m], [rad] Spread of a measurement's components.
struct Spread {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double yaw_rad = 0.0;

  [[nodiscard]] Eigen::Matrix4d information() const {
    const Eigen::Vector4d sigma(x_m, y_m, z_m, yaw_rad);
    return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  }
  [[nodiscard]] LevelPose drawn(std::mt19937_64& random) const {
    std::normal_distribution<double> n;
    const double x = n(random);
    const double y = n(random);
    const double z = n(random);
    return {x * x_m, y * y_m, z * z_m, n(random) * yaw_rad};
  }
};

inline LevelPose disturbed(const LevelPose& pose, const LevelPose& by) {
  return {pose.x_m + by.x_m, pose.y_m + by.y_m, pose.z_m + by.z_m,
          wrap_angle(pose.yaw_rad + by.yaw_rad)};
}

/// `laps` laps around a square, `side` steps of 5 m each side, climbing `rise_m` per step on two
/// sides and falling on the others.
inline std::vector<LevelPose> square_laps(int laps, int side, double rise_m = 0.0) {
  std::vector<LevelPose> truth{{}};
  for (int i = 1; i < laps * 4 * side; ++i) {
    const bool corner = i % side == 0;
    const bool up = ((i - 1) / side) % 4 < 2;
    const LevelPose step{5.0, 0.0, up ? rise_m : -rise_m, corner ? std::numbers::pi / 2 : 0.0};
    truth.push_back(truth.back() * step);
  }
  return truth;
}

/// The chain through `truth` as an odometer with this spread measures it; nodes where it believes
/// them; the first is fixed.
inline PoseGraph drifting_chain(const std::vector<LevelPose>& truth, const Spread& odometer,
                                std::mt19937_64& random) {
  PoseGraph graph;
  graph.nodes.push_back(truth.front());
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const LevelPose T = disturbed(between(truth[i - 1], truth[i]), odometer.drawn(random));
    graph.constraints.push_back({i - 1, i, T, odometer.information(), false});
    graph.nodes.push_back(graph.nodes.back() * T);
  }
  graph.fixed.assign(truth.size(), false);
  graph.fixed[0] = true;
  return graph;
}

inline void add_loop(PoseGraph& graph, const std::vector<LevelPose>& truth, std::size_t from,
                     std::size_t to, const Spread& spread, std::mt19937_64& random) {
  const LevelPose T = disturbed(between(truth[from], truth[to]), spread.drawn(random));
  graph.constraints.push_back({from, to, T, spread.information(), true});
}

/// [m] Root mean square of the distance to the truth.
inline double rms_m(const std::vector<LevelPose>& nodes, const std::vector<LevelPose>& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    sum += difference(nodes[i], truth[i]).head<3>().squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(nodes.size()));
}

}  // namespace cairn::test
