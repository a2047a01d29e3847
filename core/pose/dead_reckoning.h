#pragma once

#include <Eigen/Core>

#include "core/common/time.h"
#include "core/pose/gyro_calibration.h"
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
  GyroCalibrationConfig gyro{};

  friend bool operator==(const DeadReckoningConfig&, const DeadReckoningConfig&) = default;
};

/// Undoes the delay of an inclinometer that answers as a first-order lag: true = reading +
/// τ · d(reading)/dt. The derivative of a raw reading is mostly noise, so the reading first passes
/// two equal low-pass filters. What comes out follows the
/// truth as a critically damped second-order system of rate 4/τ: within 5 % after 1.2 τ instead of
/// 3 τ, without overshoot; white noise of the sensor comes out no larger than it went in at 20
/// readings per second or more (for τ = 1 s), 1.3 times larger at 10.
class SettlingObserver {
 public:
  /// τ ≤ 0: the instrument has no delay, readings are taken as they are.
  explicit SettlingObserver(double tau_s) : tau_s_(tau_s) {}

  /// Starts anew from a settled reading.
  void reset(double reading_rad);
  /// The true angle after `dt_s` more seconds, at the end of which the instrument says `reading`.
  double update(double reading_rad, double dt_s);

 private:
  double tau_s_;
  double once_smoothed_rad_ = 0.0;
  double twice_smoothed_rad_ = 0.0;
  double estimate_rad_ = 0.0;
};

/// The POSE module (T3.3): distance from the odometer (Eq. 2), yaw from the rate gyro, whose bias
/// and scale are learned, roll and pitch from the inclinometer with its settling delay undone by a
/// first-order observer, position by Eq. 8. Keeps the covariance of (x, y, z, yaw), which grows
/// with distance and turn.
///
/// Slip, gyro scale and inclination errors last longer than a step, so their standard deviations
/// grow in proportion to the way and turn since the last correction, however finely it is cut.
class DeadReckoning {
 public:
  /// Requires: a finite pose.
  DeadReckoning(const DeadReckoningConfig& config, const Pose& T_site_robot);

  /// Moves the pose by what the instruments say happened since the last reading. The first reading
  /// only sets the reference. Readings that are not finite, go back in time or show an inclination
  /// beyond ±π are ignored. An odometer that jumps further than kMaxStepM was reset or is at fault:
  /// that reading moves nothing, and the odometer counts on from where it now stands.
  /// Returns whether the reading was used.
  bool update(const MotionReading& reading);

  /// Replaces x, y, z and yaw by a corrected pose (localization, T4.3.3); roll and pitch go on.
  /// Requires: a finite pose.
  void correct(const Pose& T_site_robot, const Eigen::Matrix4d& covariance);

  /// Within the last `time_s` the pose turned by `turned_rad`, which was `missed_rad` too little by
  /// what the surroundings say, to `sigma_rad`: for the gyro to learn from.
  void learn(double missed_rad, double turned_rad, double time_s, double sigma_rad) {
    (void)gyro_.missed(missed_rad, turned_rad, time_s, sigma_rad);
  }
  [[nodiscard]] const GyroCalibration& gyro() const { return gyro_; }

  [[nodiscard]] const Pose& pose() const { return pose_; }
  /// Covariance of (x [m], y [m], z [m], yaw [rad]).
  [[nodiscard]] const Eigen::Matrix4d& covariance() const { return covariance_; }
  [[nodiscard]] double distance_m() const { return distance_m_; }  ///< Total distance travelled.

  /// [m] More than any robot drives between two readings.
  static constexpr double kMaxStepM = 5.0;

 private:
  void start(const MotionReading& reading);
  [[nodiscard]] double turn_rad(const MotionReading& reading, double distance_m, double dt_s);
  void move(double distance_m, double turn_rad, const Pose& before);
  void grow_covariance(const Eigen::Vector3d& step_m, double turn_rad, double dt_s);

  DeadReckoningConfig config_;
  Pose pose_;
  Eigen::Matrix4d covariance_ = Eigen::Matrix4d::Zero();
  GyroCalibration gyro_;
  double stands_s_ = 0.0;  ///< Since the wheels last turned.
  SettlingObserver roll_;
  SettlingObserver pitch_;
  MotionReading last_;
  double distance_m_ = 0.0;
  double distance_since_correction_m_ = 0.0;
  double turn_since_correction_rad_ = 0.0;
  bool has_reading_ = false;
};

}  // namespace cairn
