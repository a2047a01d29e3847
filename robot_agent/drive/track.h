#pragma once

#include <Eigen/Core>
#include <vector>

namespace cairn::agent {

/// Where the robot has driven, to find the way back where it came from.
class Track {
 public:
  /// [points] When it is full every second one is dropped, and those to come lie twice as far
  /// apart.
  static constexpr std::size_t kMaxPoints = 4096;
  static constexpr double kFirstSpacingM = 0.25;

  void add(const Eigen::Vector2d& place_m);
  /// From `place_m` back along the way to its beginning; at least one point.
  [[nodiscard]] std::vector<Eigen::Vector2d> back_from(const Eigen::Vector2d& place_m) const;

 private:
  std::vector<Eigen::Vector2d> points_m_;  ///< Oldest first. [Limit: ≤ kMaxPoints]
  double spacing_m_ = kFirstSpacingM;
};

}  // namespace cairn::agent
