#include "server/world/placing.h"

#include <algorithm>
#include <cmath>

#include "proto/codec/records.h"

namespace cairn::server {

LevelPose to_level(const SubmapPose& pose) {
  return {pose.x_mm / 1000.0, pose.y_mm / 1000.0, pose.z_mm / 1000.0, pose.yaw_1e4rad / 1e4};
}

SubmapPose to_submap_pose(const LevelPose& pose) {
  // A robot's links, put together, may lead out of every map: such a submap touches no tile.
  const auto to_mm = [](double m) {
    constexpr double kMost = proto::kMaxCoordinateMm;
    return static_cast<std::int32_t>(std::lround(std::min(std::max(m * 1000.0, -kMost), kMost)));
  };
  return {to_mm(pose.x_m), to_mm(pose.y_m), to_mm(pose.z_m),
          static_cast<std::int32_t>(std::lround(wrap_angle(pose.yaw_rad) * 1e4))};
}

bool worth_moving(const SubmapPose& from, const SubmapPose& to) {
  const Eigen::Vector4d apart = difference(to_level(from), to_level(to));
  return apart.head<3>().norm() > kWorthMovingM || std::abs(apart[3]) > kWorthMovingRad;
}

}  // namespace cairn::server
