#include "robot_agent/drive/footprint.h"

#include <algorithm>
#include <cmath>

namespace cairn::agent {
namespace {

constexpr double kStepS = 0.1;

int obstacles_under(const LocalView& view, const Footprint& footprint, const Pose& pose) {
  if (view.open_at({pose.x_m, pose.y_m})) return 0;
  const double reach_m = std::hypot(footprint.half_length_m, footprint.half_width_m);
  const double cos_yaw = std::cos(pose.yaw_rad);
  const double sin_yaw = std::sin(pose.yaw_rad);
  return view.count_obstacles({pose.x_m, pose.y_m}, reach_m, [&](const Eigen::Vector2d& off_m) {
    const double ahead_m = off_m.x() * cos_yaw + off_m.y() * sin_yaw;
    const double left_m = off_m.y() * cos_yaw - off_m.x() * sin_yaw;
    return std::abs(ahead_m) <= footprint.half_length_m &&
           std::abs(left_m) <= footprint.half_width_m;
  });
}

/// A unicycle's step.
Pose moved(Pose pose, const DriveCommand& command, double dt_s) {
  const double heading_rad = pose.yaw_rad + 0.5 * command.turn_rate_rad_s * dt_s;
  pose.x_m += command.speed_m_s * dt_s * std::cos(heading_rad);
  pose.y_m += command.speed_m_s * dt_s * std::sin(heading_rad);
  pose.yaw_rad += command.turn_rate_rad_s * dt_s;
  return pose;
}

}  // namespace

bool runs_into(const LocalView& view, const Footprint& footprint, const Braking& braking,
               const Pose& T_site_robot, const DriveCommand& command) {
  // Half the time that braking takes, at full speed, is as far.
  const double ahead_s =
      braking.reaction_s +
      0.5 * std::max(std::abs(command.speed_m_s) / braking.deceleration_m_s2,
                     std::abs(command.turn_rate_rad_s) / braking.turn_deceleration_rad_s2);
  const int now = obstacles_under(view, footprint, T_site_robot);
  Pose pose = T_site_robot;
  for (double t_s = 0.0; t_s < ahead_s; t_s += kStepS) {
    pose = moved(pose, command, kStepS);
    if (obstacles_under(view, footprint, pose) > now) return true;
  }
  return false;
}

}  // namespace cairn::agent
