#pragma once

#include <Eigen/Core>

#include "core/common/time.h"
#include "core/pose/pose.h"

namespace cairn {

/// One reading of the three instruments of the pose module (T3.3, Fig. 9).
struct MotionReading {
  MonotonicTime stamp{};
  double odometer_x_m = 0.0;    ///< Odometer position in its own frame.
  double odometer_y_m = 0.0;    ///< Odometer position in its own frame.
  double odometer_yaw_rad = 0;  ///< Odometer heading: only tells forward from backward motion.
  double gyro_yaw_rate_rad_s = 0.0;
  double inclinometer_roll_rad = 0.0;
  double inclinometer_pitch_rad = 0.0;
};

/// What is known of the instruments.
struct DeadReckoningConfig {
  /// [s] Settling time of the inclinometer to within 5 % of a step (T3.2: about 3 s for the TCM2).
  double inclinometer_settling_s = 3.0;
  /// [-] Standard deviation of travelled distance per metre (wheel slip).
  double distance_sigma_per_m = 0.02;
  /// [rad/√s] Gyro random walk.
  double yaw_sigma_rad_per_sqrt_s = 0.002;
  /// [rad/rad] Gyro scale error: standard deviation of yaw per turned radian.
  double yaw_sigma_per_rad = 0.015;
  /// [rad] Standard deviation of the inclinometer once settled.
  double incline_sigma_rad = 0.01;

  friend bool operator==(const DeadReckoningConfig&, const DeadReckoningConfig&) = default;
};

/// The POSE module (T3.3): distance from the odometer (Eq. 2), yaw from the rate gyro, roll and
/// pitch from the inclinometer with its settling delay undone by a first-order observer, position
/// by Eq. 8. Keeps the covariance of (x, y, z, yaw), which grows with distance and turn.
class DeadReckoning {
 public:
  DeadReckoning(const DeadReckoningConfig& config, const Pose& T_site_robot);

  /// Moves the pose by what the instruments say happened since the last reading. The first reading
  /// only sets the reference. Readings that are not finite, or go back in time, are ignored.
  /// Returns whether the reading was used.
  bool update(const MotionReading& reading);

  /// Replaces x, y, z and yaw by a corrected pose (localization, T4.3.3); roll and pitch go on.
  void correct(const Pose& T_site_robot, const Eigen::Matrix4d& covariance);

  [[nodiscard]] const Pose& pose() const { return pose_; }
  /// Covariance of (x [m], y [m], z [m], yaw [rad]).
  [[nodiscard]] const Eigen::Matrix4d& covariance() const { return covariance_; }
  [[nodiscard]] double distance_m() const { return distance_m_; }  ///< Total distance travelled.

 private:
  void settle(const MotionReading& reading, double dt_s);
  void grow_covariance(double distance_m, double turn_rad, double dt_s);

  DeadReckoningConfig config_;
  Pose pose_;
  Eigen::Matrix4d covariance_ = Eigen::Matrix4d::Zero();
  MotionReading last_;
  double last_inclinometer_roll_rad_ = 0.0;
  double last_inclinometer_pitch_rad_ = 0.0;
  double distance_m_ = 0.0;
  bool has_reading_ = false;
};

}  // namespace cairn
