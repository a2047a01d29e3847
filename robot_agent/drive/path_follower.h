#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/pose/pose.h"
#include "robot_agent/input/input.h"

namespace cairn::agent {

struct FollowerConfig {
  double max_speed_m_s = 0.6;
  double max_turn_rad_s = 0.9;
  double deceleration_m_s2 = 0.4;  ///< Planned braking towards the end of the path.
  double lookahead_m = 0.45;       ///< Distance of the point steered at (Coulter 1992).
  double turn_in_place_rad = 0.7;  ///< Beyond this heading error the robot turns on the spot.
  /// [m], [rad], [m/s] The same, and the fastest, where there is hardly room.
  double close_lookahead_m = 0.15;
  double close_turn_rad = 0.2;
  double close_speed_m_s = 0.2;
  double creep_m_s = 0.06;    ///< Slowest forward speed on the last centimetres.
  double creep_rad_s = 0.08;  ///< Slowest turn on the spot.
};

/// [rad/s] To turn on the spot by what is left, within max_turn_rad_s.
[[nodiscard]] double turn_on_the_spot_rad_s(const FollowerConfig& config, double left_rad);

/// Pure pursuit along a polyline (Coulter 1992), turning on the spot towards what lies behind.
class PathFollower {
 public:
  PathFollower(const FollowerConfig& config, std::vector<Eigen::Vector2d> path_m);

  /// Moves on along the path to where the robot is now. Progress never goes back.
  void advance(const Eigen::Vector2d& place_m);
  /// Wheel command from this pose, no faster than `limit_m_s`.
  [[nodiscard]] DriveCommand steer(const Pose& pose, double limit_m_s) const;

  /// The same, slow and without cutting corners: for where there is hardly room.
  [[nodiscard]] DriveCommand steer_closely(const Pose& pose, double limit_m_s) const;

  /// The rest of the way: the foot on the path, then its points.
  [[nodiscard]] std::vector<Eigen::Vector2d> ahead() const;
  [[nodiscard]] double to_go_m() const;     ///< Along the path from the foot.
  [[nodiscard]] double off_path_m() const;  ///< Distance of the robot from the foot.
  [[nodiscard]] const Eigen::Vector2d& end_m() const { return path_m_.back(); }

 private:
  [[nodiscard]] Eigen::Vector2d target(double lookahead_m) const;
  [[nodiscard]] DriveCommand steer_to(const Eigen::Vector2d& target_m, double turn_in_place_rad,
                                      const Pose& pose, double limit_m_s) const;

  FollowerConfig config_;
  std::vector<Eigen::Vector2d> path_m_;  ///< At least one point.
  std::size_t leg_ = 0;                  ///< The foot lies on path_m_[leg_] … [leg_ + 1].
  Eigen::Vector2d foot_m_;
  Eigen::Vector2d place_m_;
};

}  // namespace cairn::agent
