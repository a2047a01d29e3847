#include "robot_agent/input/vehicle.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/common/angle.h"
#include "robot_agent/input/limits.h"

namespace cairn::agent {
namespace {

constexpr double kSampleM = 0.05;         // Between the points of the footprint that are looked at.
constexpr double kTyreM = 0.06;           // Half the length of a wheel's contact with the ground.
constexpr double kLeaveM = 0.05;          // A contact is over after this way ...
constexpr double kLeaveRad = radians(5);  // ... or turn.

double approach(double now, double wanted, double limit, double most) {
  const double target = std::clamp(std::isfinite(wanted) ? wanted : 0.0, -limit, limit);
  return now + std::clamp(target - now, -most, most);
}

struct Point {
  double x_m, y_m;
};

// Points of a robot in the site.
class Placement {
 public:
  explicit Placement(const Pose& pose)
      : x_m_(pose.x_m),
        y_m_(pose.y_m),
        cos_(std::cos(pose.yaw_rad)),
        sin_(std::sin(pose.yaw_rad)) {}

  [[nodiscard]] Point in_site(double x_m, double y_m) const {
    return {x_m_ + cos_ * x_m - sin_ * y_m, y_m_ + sin_ * x_m + cos_ * y_m};
  }

 private:
  double x_m_, y_m_, cos_, sin_;
};

// The plane of a robot's wheels, from Rot(y, pitch) · Rot(x, roll).
class WheelPlane {
 public:
  explicit WheelPlane(const Pose& pose)
      : x_m_(pose.x_m),
        y_m_(pose.y_m),
        z_m_(pose.z_m),
        per_x_(-std::tan(pose.pitch_rad) * std::cos(pose.yaw_rad) -
               std::tan(pose.roll_rad) * std::sin(pose.yaw_rad)),
        per_y_(-std::tan(pose.pitch_rad) * std::sin(pose.yaw_rad) +
               std::tan(pose.roll_rad) * std::cos(pose.yaw_rad)) {}

  [[nodiscard]] double height_m(const Point& p) const {
    return z_m_ + per_x_ * (p.x_m - x_m_) + per_y_ * (p.y_m - y_m_);
  }

 private:
  double x_m_, y_m_, z_m_, per_x_, per_y_;
};

double tilt_rad(const Pose& pose) {
  return std::max(std::abs(pose.roll_rad), std::abs(pose.pitch_rad));
}

}  // namespace

std::string faults(const VehicleConfig& c) {
  Faults faults;
  faults.check("length_m", c.length_m, 0.1, 10.0);
  faults.check("width_m", c.width_m, 0.1, 10.0);
  faults.check("wheelbase_m", c.wheelbase_m, 0.05, c.length_m);
  faults.check("track_m", c.track_m, 0.05, c.width_m);
  faults.check("max_speed_m_s", c.max_speed_m_s, 1e-3, 10.0);
  faults.check("max_acceleration_m_s2", c.max_acceleration_m_s2, 1e-3, 20.0);
  faults.check("max_turn_rate_rad_s", c.max_turn_rate_rad_s, 1e-3, 10.0);
  faults.check("max_turn_acceleration_rad_s2", c.max_turn_acceleration_rad_s2, 1e-3, 50.0);
  faults.check("climb_limit_m", c.climb_limit_m, 1e-3, 1.0);
  faults.check("max_tilt_rad", c.max_tilt_rad, 0.01, 1.2);
  faults.check("slip", c.slip, 0.0, 0.5);
  faults.check("slip_per_slope", c.slip_per_slope, 0.0, 1.0);
  return faults.text();
}

Vehicle::Vehicle(const VehicleConfig& config, const HeightRaster& surface, const Pose& start)
    : config_(config), surface_(surface), pose_(on_wheels(start.x_m, start.y_m, start.yaw_rad)) {}

void Vehicle::step(const DriveCommand& command, double dt_s) {
  wheel_speed_m_s_ = approach(wheel_speed_m_s_, command.speed_m_s, config_.max_speed_m_s,
                              config_.max_acceleration_m_s2 * dt_s);
  turn_rate_rad_s_ =
      approach(turn_rate_rad_s_, command.turn_rate_rad_s, config_.max_turn_rate_rad_s,
               config_.max_turn_acceleration_rad_s2 * dt_s);
  if (wheel_speed_m_s_ == 0.0 && turn_rate_rad_s_ == 0.0) {
    return;
  }
  const double uphill = std::max(0.0, -std::sin(pose_.pitch_rad) * wheel_speed_m_s_);
  const double grip =
      1.0 - config_.slip -
      (wheel_speed_m_s_ == 0.0 ? 0.0
                               : config_.slip_per_slope * uphill / std::abs(wheel_speed_m_s_));
  const double way = wheel_speed_m_s_ * grip * dt_s * std::cos(pose_.pitch_rad);
  const double heading = pose_.yaw_rad + 0.5 * turn_rate_rad_s_ * dt_s;
  const Pose next =
      on_wheels(pose_.x_m + way * std::cos(heading), pose_.y_m + way * std::sin(heading),
                wrap_angle(pose_.yaw_rad + turn_rate_rad_s_ * dt_s));
  // Where it is stuck already it may still move to where it is stuck less.
  const double ahead = trouble(pose_, next);
  if (ahead > 0.0 && ahead > trouble(pose_, pose_)) {
    touch();
    return;
  }
  pose_ = next;
  leave_contact();
}

bool Vehicle::stands_free(double x_m, double y_m, double yaw_rad) const {
  const Pose there = on_wheels(x_m, y_m, yaw_rad);
  return trouble(there, there) <= 0.0;
}

Pose Vehicle::on_wheels(double x_m, double y_m, double yaw_rad) const {
  Pose pose;
  pose.x_m = x_m;
  pose.y_m = y_m;
  pose.yaw_rad = yaw_rad;
  const double x = 0.5 * config_.wheelbase_m;
  const double y = 0.5 * config_.track_m;
  const double front_left = wheel_height_m(pose, x, y);
  const double front_right = wheel_height_m(pose, x, -y);
  const double rear_left = wheel_height_m(pose, -x, y);
  const double rear_right = wheel_height_m(pose, -x, -y);
  pose.z_m = 0.25 * (front_left + front_right + rear_left + rear_right);
  // Positive pitch lowers the nose, positive roll lifts the left side.
  pose.pitch_rad =
      std::atan((rear_left + rear_right - front_left - front_right) / (2.0 * config_.wheelbase_m));
  pose.roll_rad =
      std::atan((front_left + rear_left - front_right - rear_right) / (2.0 * config_.track_m));
  return pose;
}

double Vehicle::wheel_height_m(const Pose& pose, double wheel_x_m, double wheel_y_m) const {
  const Placement placement(pose);
  double highest = -HeightRaster::kOutside;
  for (const double along : {-kTyreM, 0.0, kTyreM}) {
    const Point p = placement.in_site(wheel_x_m + along, wheel_y_m);
    highest = std::max(highest, surface_.height_m(p.x_m, p.y_m));
  }
  return highest;
}

// How far beyond its limits the vehicle would be; ≤ 0 is well. [m, and rad for the tilt]
double Vehicle::trouble(const Pose& plane, const Pose& next) const {
  return std::max({highest_above(plane, next) - config_.climb_limit_m,
                   deepest_below(plane, next) - config_.climb_limit_m,
                   tilt_rad(next) - config_.max_tilt_rad});
}

double Vehicle::highest_above(const Pose& plane, const Pose& next) const {
  const int along = static_cast<int>(std::ceil(config_.length_m / kSampleM));
  const int across = static_cast<int>(std::ceil(config_.width_m / kSampleM));
  const Placement placement(next);
  const WheelPlane wheels(plane);
  double highest = -HeightRaster::kOutside;
  for (int i = 0; i <= along; ++i) {
    for (int j = 0; j <= across; ++j) {
      const Point p = placement.in_site(config_.length_m * (double(i) / along - 0.5),
                                        config_.width_m * (double(j) / across - 0.5));
      highest = std::max(highest, surface_.height_m(p.x_m, p.y_m) - wheels.height_m(p));
    }
  }
  return highest;
}

double Vehicle::deepest_below(const Pose& plane, const Pose& next) const {
  const Placement placement(next);
  const WheelPlane wheels(plane);
  double deepest = -HeightRaster::kOutside;
  for (const double x : {-0.5 * config_.wheelbase_m, 0.5 * config_.wheelbase_m}) {
    for (const double y : {-0.5 * config_.track_m, 0.5 * config_.track_m}) {
      const double drop = wheels.height_m(placement.in_site(x, y)) - wheel_height_m(next, x, y);
      deepest = std::max(deepest, drop);
    }
  }
  return deepest;
}

void Vehicle::touch() {
  wheel_speed_m_s_ = 0.0;
  turn_rate_rad_s_ = 0.0;
  if (!in_contact_) {
    ++collisions_;
    in_contact_ = true;
    contact_ = pose_;
  }
}

void Vehicle::leave_contact() {
  const double way = std::hypot(pose_.x_m - contact_.x_m, pose_.y_m - contact_.y_m);
  const double turn = std::abs(wrap_angle(pose_.yaw_rad - contact_.yaw_rad));
  in_contact_ = in_contact_ && way < kLeaveM && turn < kLeaveRad;
}

}  // namespace cairn::agent
