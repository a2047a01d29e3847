#pragma once

#include <Eigen/Core>

namespace cairn {

/// What is known beforehand of a rate gyro.
struct GyroCalibrationConfig {
  double scale_sigma = 0.015;                ///< [-] Of a gyro out of its box.
  double bias_sigma_rad_s = 0.001;           ///< [rad/s] The same.
  double bias_walk_rad_s_per_sqrt_s = 1e-5;  ///< So fast the bias changes, with warmth most of all.
  double scale_walk_per_sqrt_s = 2e-5;       ///< [1/√s]
  double walk_rad_per_sqrt_s = 0.001;        ///< Angle random walk.
  double gate_sigmas = 3.5;                  ///< [σ] What contradicts more is no measurement.

  friend bool operator==(const GyroCalibrationConfig&, const GyroCalibrationConfig&) = default;
};

/// A rate gyro's bias and scale, learned while driving: a robot whose wheels stand does not turn,
/// and what the surroundings say a robot turned by, the gyro should have said too. A Kalman filter
/// over two states that hardly change: reading = (1 + scale) · rate + bias. However long the time
/// between readings, it never knows less than beforehand, and the scale stays within ±kMaxScale.
class GyroCalibration {
 public:
  static constexpr double kMaxScale = 0.2;  ///< [-] No gyro is worse; a reading is divided by it.

  explicit GyroCalibration(const GyroCalibrationConfig& config);

  /// [rad/s] What the gyro should have read.
  [[nodiscard]] double rate_rad_s(double reading_rad_s) const {
    return (reading_rad_s - bias_rad_s()) / (1.0 + scale());
  }
  /// Requires: dt_s ≥ 0.
  void pass(double dt_s);
  /// The wheels stood for this long, the gyro reading this in the mean. Requires: dt_s > 0.
  /// Returns whether the gyro agrees: else somebody turns the robot.
  bool stood(double reading_rad_s, double dt_s);
  /// Within `time_s` the calibrated gyro said the robot turned by `turned_rad`, and it was
  /// `missed_rad` more, known to `sigma_rad`. Returns whether that is believed.
  bool missed(double missed_rad, double turned_rad, double time_s, double sigma_rad);

  [[nodiscard]] double scale() const { return state_[0]; }
  [[nodiscard]] double bias_rad_s() const { return state_[1]; }
  /// [rad] One sigma of what it may miss while the robot turns by `turned_rad` within `time_s`.
  [[nodiscard]] double sigma_rad(double turned_rad, double time_s) const;

 private:
  bool update(const Eigen::Vector2d& H, double innovation, double variance);

  GyroCalibrationConfig config_;
  Eigen::Vector2d state_ = Eigen::Vector2d::Zero();  ///< Scale [-], bias [rad/s].
  Eigen::Matrix2d covariance_;
};

}  // namespace cairn
