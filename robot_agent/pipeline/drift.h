#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/pose/dead_reckoning.h"
#include "core/pose/pose.h"

namespace cairn::agent {

/// How sure the robot is of its pose relative to a place where it once was: covariance of
/// (x, y, z [m], yaw [rad]) along the axes of its local frame, growing with each step. Slip, gyro
/// scale and inclination errors last longer than a step, so their standard deviations grow in
/// proportion to way and turn since that place, as in DeadReckoning.
class Drift {
 public:
  explicit Drift(const DeadReckoningConfig& config) : config_(config) {}

  /// Here the covariance is this.
  void start(const Eigen::Matrix4d& covariance);
  /// The robot went from one pose to the next in the local frame, in this time.
  void add(const Pose& T_local_before, const Pose& T_local_after, double dt_s);
  /// Local tracking found the robot here, with this information about (x, y, yaw) against the
  /// surfaces of before. Counts instead of what dead reckoning added since the last `kept` place,
  /// except where the surfaces told nothing.
  void track(const Pose& T_local_robot, const Eigen::Matrix3d& information, bool kept);

  [[nodiscard]] const Eigen::Matrix4d& covariance() const { return covariance_; }

 private:
  [[nodiscard]] Eigen::Matrix3d untracked() const;

  DeadReckoningConfig config_;
  Eigen::Matrix4d covariance_ = Eigen::Matrix4d::Zero();
  Eigen::Matrix4d kept_covariance_ = Eigen::Matrix4d::Zero();  ///< At the last kept place.
  std::optional<Pose> T_local_kept_;
  double kept_way_m_ = 0.0;  ///< Way since then.
  double kept_turn_rad_ = 0.0;
  double way_m_ = 0.0;
  double turn_rad_ = 0.0;
};

/// The same covariance along axes that are turned by `yaw_rad` against the present ones.
[[nodiscard]] Eigen::Matrix4d turned(const Eigen::Matrix4d& covariance, double yaw_rad);

}  // namespace cairn::agent
