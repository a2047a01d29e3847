#pragma once

#include <cmath>

#include "core/common/angle.h"
#include "core/sensor/laser.h"
#include "tests/unit/core/localization/test_ground.h"

namespace cairn::test {

inline constexpr double kSensorHeightM = 0.8;

/// A sweep that looks down at the ground all around: each beam ends where it meets it.
template <class Ground = RichGround>
Scan look(const LaserSpec& laser, const Pose& truth, const Ground& ground = {}) {
  const Eigen::Isometry3d T = to_transform(truth) * to_transform(laser.T_robot_sensor);
  Scan scan;
  for (int i = 0; i < laser.beam_count; ++i) {
    const double angle = laser.first_angle_rad + i * laser.step_rad;
    double range = 0.2;
    for (; range < laser.max_range_m; range += 0.02) {
      const Eigen::Vector3d p =
          T * Eigen::Vector3d(range * std::cos(angle), range * std::sin(angle), 0.0);
      if (p.z() <= ground(p.x(), p.y())) break;
    }
    scan.range_m.push_back(static_cast<float>(range));
  }
  return scan;
}

inline LaserSpec down_looking(double pitch_deg) {
  LaserSpec laser;
  laser.T_robot_sensor = {.z_m = kSensorHeightM, .pitch_rad = radians(pitch_deg)};
  laser.max_range_m = 8.0;
  return laser;
}

}  // namespace cairn::test
