#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/common/angle.h"
#include "core/pose/pose.h"
#include "robot_agent/input/input.h"

/// A robot that does exactly what its wheels are told.
namespace cairn::agent::testing {

inline constexpr double kStepS = 0.05;

inline Eigen::Vector2d place_of(const Pose& pose) { return {pose.x_m, pose.y_m}; }

inline void roll(Pose& pose, const DriveCommand& wheels) {
  const double middle_rad = pose.yaw_rad + 0.5 * wheels.turn_rate_rad_s * kStepS;
  pose.x_m += wheels.speed_m_s * kStepS * std::cos(middle_rad);
  pose.y_m += wheels.speed_m_s * kStepS * std::sin(middle_rad);
  pose.yaw_rad = wrap_angle(pose.yaw_rad + wheels.turn_rate_rad_s * kStepS);
}

}  // namespace cairn::agent::testing
