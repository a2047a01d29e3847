#include "server/world/placing.h"

#include <cmath>

namespace cairn::server {

LevelPose to_level(const SubmapPose& pose) {
  return {pose.x_mm / 1000.0, pose.y_mm / 1000.0, pose.z_mm / 1000.0, pose.yaw_1e4rad / 1e4};
}

SubmapPose to_submap_pose(const LevelPose& pose) {
  const auto rounded = [](double value) { return static_cast<std::int32_t>(std::lround(value)); };
  return {rounded(pose.x_m * 1000.0), rounded(pose.y_m * 1000.0), rounded(pose.z_m * 1000.0),
          rounded(wrap_angle(pose.yaw_rad) * 1e4)};
}

}  // namespace cairn::server
