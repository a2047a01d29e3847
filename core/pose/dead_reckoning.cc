#include "core/pose/dead_reckoning.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/common/angle.h"

namespace cairn {
namespace {

// A first-order lag is within 5 % of a step after three time constants (e⁻³ = 0.0498).
constexpr double kTimeConstantsToSettle = 3.0;
// Rate of the observer's filters in units of 1/τ; SettlingObserver's docstring tells what it buys.
constexpr double kObserverRate = 4.0;

// Between two readings wheels that stand tell no more than this; the body has come to rest a while
// after them.
constexpr double kStandsM = 1e-4;
constexpr double kStandsRad = 1e-4;
constexpr double kSettledS = 0.5;

bool acceptable(const MotionReading& r) {
  return std::isfinite(r.odometer_x_m) && std::isfinite(r.odometer_y_m) &&
         std::isfinite(r.odometer_yaw_rad) && std::isfinite(r.gyro_yaw_rate_rad_s) &&
         std::abs(r.inclinometer_roll_rad) <= std::numbers::pi &&
         std::abs(r.inclinometer_pitch_rad) <= std::numbers::pi;
}

/// Equation (2), with the sign that tells forward from backward.
double travelled_m(const MotionReading& from, const MotionReading& to) {
  const double dx = to.odometer_x_m - from.odometer_x_m;
  const double dy = to.odometer_y_m - from.odometer_y_m;
  const double half_turn = 0.5 * wrap_angle(to.odometer_yaw_rad - from.odometer_yaw_rad);
  const double heading = from.odometer_yaw_rad + half_turn;
  const double ahead = dx * std::cos(heading) + dy * std::sin(heading);
  return std::copysign(std::hypot(dx, dy), ahead);
}

/// How much the variance (sigma · total)² grows when `total` grows by `step`.
double variance_growth(double sigma, double total, double step) {
  return sigma * sigma * step * (2.0 * total + step);
}

}  // namespace

void SettlingObserver::reset(double reading_rad) {
  once_smoothed_rad_ = reading_rad;
  twice_smoothed_rad_ = reading_rad;
  estimate_rad_ = reading_rad;
}

double SettlingObserver::update(double reading_rad, double dt_s) {
  if (tau_s_ <= 0.0) return reading_rad;
  if (dt_s <= 0.0) return estimate_rad_;
  const double share = 1.0 - std::exp(-kObserverRate * dt_s / tau_s_);
  const double before_rad = twice_smoothed_rad_;
  once_smoothed_rad_ += share * (reading_rad - once_smoothed_rad_);
  twice_smoothed_rad_ += share * (once_smoothed_rad_ - twice_smoothed_rad_);
  // reading + τ · d(reading)/dt, exactly for a truth that held still during the step.
  const double settled_share = 1.0 - std::exp(-dt_s / tau_s_);
  estimate_rad_ = before_rad + (twice_smoothed_rad_ - before_rad) / settled_share;
  return estimate_rad_;
}

DeadReckoning::DeadReckoning(const DeadReckoningConfig& config, const Pose& T_site_robot)
    : config_(config),
      pose_(T_site_robot),
      gyro_(config.gyro),
      roll_(config.inclinometer_settling_s / kTimeConstantsToSettle),
      pitch_(config.inclinometer_settling_s / kTimeConstantsToSettle) {
  assert(is_finite(T_site_robot));
}

bool DeadReckoning::update(const MotionReading& reading) {
  if (!acceptable(reading)) return false;
  if (!has_reading_) {
    start(reading);
    return true;
  }
  const double dt_s = to_seconds(reading.stamp - last_.stamp);
  if (dt_s < 0.0) return false;
  const double distance_m = travelled_m(last_, reading);
  if (!(std::abs(distance_m) <= kMaxStepM)) {
    // Gyro and inclinometer go on from the last good reading; only the odometer starts anew.
    last_.odometer_x_m = reading.odometer_x_m;
    last_.odometer_y_m = reading.odometer_y_m;
    last_.odometer_yaw_rad = reading.odometer_yaw_rad;
    return false;
  }
  const Pose before = pose_;
  const double turned_rad = turn_rad(reading, distance_m, dt_s);
  pose_.roll_rad = wrap_angle(roll_.update(reading.inclinometer_roll_rad, dt_s));
  pose_.pitch_rad = std::clamp(pitch_.update(reading.inclinometer_pitch_rad, dt_s),
                               -std::numbers::pi / 2.0, std::numbers::pi / 2.0);
  move(distance_m, turned_rad, before);
  const Eigen::Vector3d step_m(pose_.x_m - before.x_m, pose_.y_m - before.y_m,
                               pose_.z_m - before.z_m);
  grow_covariance(step_m, turned_rad, dt_s);
  last_ = reading;
  return true;
}

void DeadReckoning::start(const MotionReading& reading) {
  last_ = reading;
  roll_.reset(reading.inclinometer_roll_rad);
  pitch_.reset(reading.inclinometer_pitch_rad);
  has_reading_ = true;
}

/// Since the last reading; from wheels that stand the gyro learns its bias.
double DeadReckoning::turn_rad(const MotionReading& reading, double distance_m, double dt_s) {
  const double reading_rad_s = 0.5 * (last_.gyro_yaw_rate_rad_s + reading.gyro_yaw_rate_rad_s);
  const double wheels_rad = wrap_angle(reading.odometer_yaw_rad - last_.odometer_yaw_rad);
  const bool stands = std::abs(distance_m) < kStandsM && std::abs(wheels_rad) < kStandsRad;
  stands_s_ = stands ? stands_s_ + dt_s : 0.0;
  gyro_.pass(dt_s);
  const bool settled = stands_s_ > kSettledS && dt_s > 0.0;
  if (settled && !gyro_.stood(reading_rad_s, dt_s)) stands_s_ = 0.0;  // Somebody carries it.
  return gyro_.rate_rad_s(reading_rad_s) * dt_s;
}

/// Equation (8) with the orientation half-way between `before` and the roll and pitch of now.
void DeadReckoning::move(double distance_m, double turn_rad, const Pose& before) {
  Pose middle = before;
  middle.roll_rad += 0.5 * wrap_angle(pose_.roll_rad - before.roll_rad);
  middle.pitch_rad = 0.5 * (before.pitch_rad + pose_.pitch_rad);
  middle.yaw_rad += 0.5 * turn_rad;
  const Eigen::Vector3d p_site = to_transform(middle) * Eigen::Vector3d(distance_m, 0.0, 0.0);
  pose_.x_m = p_site.x();
  pose_.y_m = p_site.y();
  pose_.z_m = p_site.z();
  pose_.yaw_rad = wrap_angle(before.yaw_rad + turn_rad);
  distance_m_ += std::abs(distance_m);
}

void DeadReckoning::grow_covariance(const Eigen::Vector3d& step_m, double turn_rad, double dt_s) {
  // A wrong yaw carries the step sideways.
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F(0, 3) = -step_m.y();
  F(1, 3) = step_m.x();
  covariance_ = F * covariance_ * F.transpose();

  const double length_m = step_m.norm();
  const double turned_rad = std::abs(turn_rad);
  if (length_m > 0.0) {
    const Eigen::Vector3d ahead = step_m / length_m;
    covariance_.topLeftCorner<3, 3>() +=
        variance_growth(config_.distance_sigma_per_m, distance_since_correction_m_, length_m) *
        ahead * ahead.transpose();
    covariance_(2, 2) +=
        variance_growth(config_.incline_sigma_rad, distance_since_correction_m_, length_m);
  }
  covariance_(3, 3) +=
      config_.yaw_sigma_rad_per_sqrt_s * config_.yaw_sigma_rad_per_sqrt_s * dt_s +
      variance_growth(config_.yaw_sigma_per_rad, turn_since_correction_rad_, turned_rad);
  distance_since_correction_m_ += length_m;
  turn_since_correction_rad_ += turned_rad;
}

void DeadReckoning::correct(const Pose& T_site_robot, const Eigen::Matrix4d& covariance) {
  assert(is_finite(T_site_robot));
  pose_.x_m = T_site_robot.x_m;
  pose_.y_m = T_site_robot.y_m;
  pose_.z_m = T_site_robot.z_m;
  pose_.yaw_rad = wrap_angle(T_site_robot.yaw_rad);
  covariance_ = covariance;
  distance_since_correction_m_ = 0.0;
  turn_since_correction_rad_ = 0.0;
}

}  // namespace cairn
