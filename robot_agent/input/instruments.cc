#include "robot_agent/input/instruments.h"

#include <cmath>

#include "robot_agent/input/limits.h"

namespace cairn::agent {

std::string faults(const InstrumentConfig& c) {
  Faults faults;
  faults.check("odometer_yaw_scale", c.odometer_yaw_scale, 0.0, 1.0);
  faults.check("odometer_yaw_drift_rad_per_m", c.odometer_yaw_drift_rad_per_m, 0.0, 1.0);
  faults.check("odometer_distance_scale", c.odometer_distance_scale, 0.0, 0.5);
  faults.check("gyro_scale", c.gyro_scale, 0.0, 0.5);
  faults.check("gyro_bias_rad_s", c.gyro_bias_rad_s, 0.0, 1.0);
  faults.check("gyro_walk_rad_per_sqrt_s", c.gyro_walk_rad_per_sqrt_s, 0.0, 1.0);
  faults.check("inclinometer_settling_s", c.inclinometer_settling_s, 0.0, 60.0);
  faults.check("inclinometer_sigma_rad", c.inclinometer_sigma_rad, 0.0, 0.5);
  return faults.text();
}

Instruments::Instruments(const InstrumentConfig& config, std::uint64_t seed, const Pose& start)
    : config_(config),
      noise_(seed, 1),
      odometer_yaw_scale_(noise_.sign() * config.odometer_yaw_scale),
      odometer_yaw_drift_rad_per_m_(noise_.normal() * config.odometer_yaw_drift_rad_per_m),
      odometer_distance_scale_(noise_.normal() * config.odometer_distance_scale),
      gyro_scale_(noise_.sign() * config.gyro_scale),
      gyro_bias_rad_s_(noise_.normal() * config.gyro_bias_rad_s),
      settled_roll_rad_(start.roll_rad),
      settled_pitch_rad_(start.pitch_rad) {}

void Instruments::follow(const Vehicle& vehicle, double dt_s) {
  roll_wheels(vehicle, dt_s);
  settle_inclinometer(vehicle.pose(), dt_s);
  turned_rad_ += vehicle.turn_rate_rad_s() * dt_s;
  passed_s_ += dt_s;
}

void Instruments::roll_wheels(const Vehicle& vehicle, double dt_s) {
  const double way = vehicle.wheel_speed_m_s() * (1.0 + odometer_distance_scale_) * dt_s;
  const double turn = vehicle.turn_rate_rad_s() * (1.0 + odometer_yaw_scale_) * dt_s +
                      odometer_yaw_drift_rad_per_m_ * std::abs(way);
  const double heading = odometer_yaw_rad_ + 0.5 * turn;
  odometer_x_m_ += way * std::cos(heading);
  odometer_y_m_ += way * std::sin(heading);
  odometer_yaw_rad_ = wrap_angle(odometer_yaw_rad_ + turn);
}

// First order: e^-3 = 5 % is left after the settling time.
void Instruments::settle_inclinometer(const Pose& pose, double dt_s) {
  const double part = config_.inclinometer_settling_s > 0.0
                          ? -std::expm1(-3.0 * dt_s / config_.inclinometer_settling_s)
                          : 1.0;
  settled_roll_rad_ += part * (pose.roll_rad - settled_roll_rad_);
  settled_pitch_rad_ += part * (pose.pitch_rad - settled_pitch_rad_);
}

MotionReading Instruments::read(MonotonicTime stamp) {
  MotionReading reading;
  reading.stamp = stamp;
  reading.odometer_x_m = odometer_x_m_;
  reading.odometer_y_m = odometer_y_m_;
  reading.odometer_yaw_rad = odometer_yaw_rad_;
  reading.gyro_yaw_rate_rad_s = read_gyro_rad_s();
  reading.inclinometer_roll_rad =
      settled_roll_rad_ + config_.inclinometer_sigma_rad * noise_.normal();
  reading.inclinometer_pitch_rad =
      settled_pitch_rad_ + config_.inclinometer_sigma_rad * noise_.normal();
  return reading;
}

double Instruments::read_gyro_rad_s() {
  if (passed_s_ <= 0.0) {
    return gyro_bias_rad_s_;
  }
  // White noise of the rate that integrates to the given random walk of the angle.
  const double walk = config_.gyro_walk_rad_per_sqrt_s / std::sqrt(passed_s_) * noise_.normal();
  const double rate = turned_rad_ / passed_s_ * (1.0 + gyro_scale_) + gyro_bias_rad_s_ + walk;
  turned_rad_ = 0.0;
  passed_s_ = 0.0;
  return rate;
}

}  // namespace cairn::agent
