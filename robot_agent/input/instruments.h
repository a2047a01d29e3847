#pragma once

#include <cstdint>
#include <string>

#include "core/common/angle.h"
#include "core/pose/dead_reckoning.h"
#include "robot_agent/input/noise.h"
#include "robot_agent/input/vehicle.h"

namespace cairn::agent {

/// What the odometer, the rate gyro and the inclinometer get wrong. The defaults give what T3.3
/// reports: on a lap of the room (about 32 m, 360°, 0.5 m/s) the odometer's heading is off by about
/// 40°, the gyro's by about 5°. "One sigma" values are drawn once per robot.
struct InstrumentConfig {
  /// [-] Size of the odometer's error per turned angle; its sign is drawn, skid steering decides.
  double odometer_yaw_scale = 0.11;
  /// [rad/m] One sigma of the odometer's heading drift on the way (uneven tyres).
  double odometer_yaw_drift_rad_per_m = radians(0.15);
  /// [-] One sigma of the odometer's scale of distance.
  double odometer_distance_scale = 0.01;
  /// [-] Size of the gyro's scale error; its sign is drawn.
  double gyro_scale = 0.012;
  /// [rad/s] One sigma of the gyro's bias.
  double gyro_bias_rad_s = radians(0.03);
  /// [rad/√s] Random walk of the heading integrated from the gyro.
  double gyro_walk_rad_per_sqrt_s = radians(0.05);
  /// [s] The inclinometer is within 5 % of a new tilt after this (T3.2: TCM2, 3 s).
  double inclinometer_settling_s = 3.0;
  /// [rad] Standard deviation of one inclinometer reading.
  double inclinometer_sigma_rad = radians(0.2);
};

/// Every fault of the configuration in one sentence each, joined by "; ". Empty when it is sound.
[[nodiscard]] std::string faults(const InstrumentConfig& config);

/// The three instruments of the pose module (T3.3), fed with what the vehicle really does.
class Instruments {
 public:
  Instruments(const InstrumentConfig& config, std::uint64_t seed, const Pose& start);

  /// Follows the vehicle through its last step. Requires: dt_s > 0.
  void follow(const Vehicle& vehicle, double dt_s);
  /// The next reading; the gyro's rate is the mean since the one before.
  [[nodiscard]] MotionReading read(MonotonicTime stamp);

 private:
  void roll_wheels(const Vehicle& vehicle, double dt_s);
  void settle_inclinometer(const Pose& pose, double dt_s);
  [[nodiscard]] double read_gyro_rad_s();

  InstrumentConfig config_;
  Noise noise_;
  double odometer_yaw_scale_;
  double odometer_yaw_drift_rad_per_m_;
  double odometer_distance_scale_;
  double gyro_scale_;
  double gyro_bias_rad_s_;
  double odometer_x_m_ = 0.0;
  double odometer_y_m_ = 0.0;
  double odometer_yaw_rad_ = 0.0;
  double turned_rad_ = 0.0;  ///< Since the last reading.
  double passed_s_ = 0.0;    ///< Since the last reading.
  double settled_roll_rad_;
  double settled_pitch_rad_;
};

}  // namespace cairn::agent
