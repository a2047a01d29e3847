#include "core/pose/pose.h"

#include <algorithm>
#include <cmath>

namespace cairn {

Eigen::Isometry3d to_transform(const Pose& pose) {
  // Equations (3)-(7).
  Eigen::Isometry3d T(Eigen::Translation3d(pose.x_m, pose.y_m, pose.z_m));
  T.rotate(Eigen::AngleAxisd(pose.yaw_rad, Eigen::Vector3d::UnitZ()));
  T.rotate(Eigen::AngleAxisd(pose.pitch_rad, Eigen::Vector3d::UnitY()));
  T.rotate(Eigen::AngleAxisd(pose.roll_rad, Eigen::Vector3d::UnitX()));
  return T;
}

Pose from_transform(const Eigen::Isometry3d& T) {
  // At the pole only yaw and roll together can be told; rounding leaves about this much cos(pitch).
  constexpr double kPole = 1e-9;
  const auto R = T.linear();
  Pose pose{T.translation().x(), T.translation().y(), T.translation().z()};
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  pose.pitch_rad = std::atan2(-R(2, 0), cos_pitch);
  if (cos_pitch < kPole) {
    pose.yaw_rad = std::atan2(-R(0, 1), R(1, 1));
    return pose;
  }
  pose.yaw_rad = std::atan2(R(1, 0), R(0, 0));
  pose.roll_rad = std::atan2(R(2, 1), R(2, 2));
  return pose;
}

bool is_finite(const Pose& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.z_m) &&
         std::isfinite(pose.roll_rad) && std::isfinite(pose.pitch_rad) &&
         std::isfinite(pose.yaw_rad);
}

}  // namespace cairn
