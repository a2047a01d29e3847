#pragma once

#include <string>

#include "core/pose/pose.h"
#include "robot_agent/input/height_raster.h"
#include "robot_agent/input/input.h"

namespace cairn::agent {

/// The ATRV-Jr as a skid-steered vehicle (T3.1).
struct VehicleConfig {
  double length_m = 0.78;                     ///< [m] Footprint along x. [Limit: 0.1 … 10]
  double width_m = 0.64;                      ///< [m] Footprint along y. [Limit: 0.1 … 10]
  double wheelbase_m = 0.50;                  ///< [m] Front to rear axle. [Limit: 0.05 … length]
  double track_m = 0.56;                      ///< [m] Left to right wheels. [Limit: 0.05 … width]
  double max_speed_m_s = 1.0;                 ///< [m/s] Forward and back. [Limit: > 0 … 10]
  double max_acceleration_m_s2 = 1.0;         ///< [m/s²] Also braking. [Limit: > 0 … 20]
  double max_turn_rate_rad_s = 1.0;           ///< [rad/s] [Limit: > 0 … 10]
  double max_turn_acceleration_rad_s2 = 2.0;  ///< [rad/s²] [Limit: > 0 … 50]
  double climb_limit_m = 0.1;    ///< [m] Highest step, up or down (T4.2). [Limit: > 0 … 1]
  double max_tilt_rad = 0.6;     ///< [rad] Beyond, it would tip over. [Limit: > 0 … 1.2]
  double slip = 0.01;            ///< [-] Lost wheel travel on level ground. [Limit: 0 … 0.5]
  double slip_per_slope = 0.15;  ///< [-] More of it per sin(pitch) uphill. [Limit: 0 … 1]
};

/// Every fault of the configuration in one sentence each, joined by "; ". Empty when it is sound.
[[nodiscard]] std::string faults(const VehicleConfig& config);

/// A unicycle with limited acceleration whose four wheels follow the surface. A move that would
/// bring the footprint onto something higher above the wheels' plane than the climb limit, a wheel
/// over a deeper drop, or the body beyond its tilt limit is not made: the vehicle stands, and one
/// collision is counted until it has got away from there by 5 cm or 5°.
class Vehicle {
 public:
  /// Keeps a reference: `surface` must outlive the vehicle.
  Vehicle(const VehicleConfig& config, const HeightRaster& surface, const Pose& start);

  /// Moves for a short time. Requires: 0 < dt_s ≤ 0.02.
  void step(const DriveCommand& command, double dt_s);

  [[nodiscard]] const Pose& pose() const { return pose_; }
  [[nodiscard]] int collisions() const { return collisions_; }
  /// Whether it could stand there without touching anything.
  [[nodiscard]] bool stands_free(double x_m, double y_m, double yaw_rad) const;

  // What the wheels and the body did in the last step, for the instruments.
  [[nodiscard]] double wheel_speed_m_s() const { return wheel_speed_m_s_; }
  [[nodiscard]] double turn_rate_rad_s() const { return turn_rate_rad_s_; }

 private:
  [[nodiscard]] Pose on_wheels(double x_m, double y_m, double yaw_rad) const;
  [[nodiscard]] double wheel_height_m(const Pose& pose, double wheel_x_m, double wheel_y_m) const;
  [[nodiscard]] double trouble(const Pose& plane, const Pose& next) const;
  [[nodiscard]] double highest_above(const Pose& plane, const Pose& next) const;
  [[nodiscard]] double deepest_below(const Pose& plane, const Pose& next) const;
  void touch();
  void leave_contact();

  VehicleConfig config_;
  const HeightRaster& surface_;
  Pose pose_;
  double wheel_speed_m_s_ = 0.0;
  double turn_rate_rad_s_ = 0.0;
  int collisions_ = 0;
  bool in_contact_ = false;
  Pose contact_;
};

}  // namespace cairn::agent
