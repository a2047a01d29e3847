#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/map/submap.h"
#include "core/pose/pose.h"
#include "core/sensor/laser.h"

/// Poses and beams between the frames of robot, submap and site; integers and real numbers.
namespace cairn::agent {

[[nodiscard]] inline std::int32_t to_mm(double m) {
  return static_cast<std::int32_t>(std::lround(m * 1000.0));
}

[[nodiscard]] inline Pose pose_of(const SubmapPose& T) {
  return {.x_m = T.x_mm / 1000.0,
          .y_m = T.y_mm / 1000.0,
          .z_m = T.z_mm / 1000.0,
          .yaw_rad = T.yaw_1e4rad / 1e4};
}

/// Roll and pitch are left out: submaps are level.
[[nodiscard]] inline SubmapPose rounded(const Pose& T) {
  return {to_mm(T.x_m), to_mm(T.y_m), to_mm(T.z_m),
          static_cast<std::int32_t>(std::lround(T.yaw_rad * 1e4))};
}

/// T_a_b · T_b_c.
[[nodiscard]] inline Pose compose(const Pose& T_a_b, const Pose& T_b_c) {
  return from_transform(to_transform(T_a_b) * to_transform(T_b_c));
}

/// T_a_b⁻¹ · T_a_c.
[[nodiscard]] inline Pose from_to(const Pose& T_a_b, const Pose& T_a_c) {
  return from_transform(to_transform(T_a_b).inverse() * to_transform(T_a_c));
}

/// The same place and heading, upright.
[[nodiscard]] inline Pose level(const Pose& pose) {
  return {.x_m = pose.x_m, .y_m = pose.y_m, .z_m = pose.z_m, .yaw_rad = pose.yaw_rad};
}

/// Far hits still tell that the way to them is free.
[[nodiscard]] inline std::vector<Beam> shortened(std::vector<Beam> beams, double range_m) {
  for (Beam& beam : beams) {
    const Eigen::Vector3d along = beam.end_m - beam.origin_m;
    if (!beam.hit || along.squaredNorm() <= range_m * range_m) continue;
    beam.end_m = beam.origin_m + along.normalized() * range_m;
    beam.hit = false;
  }
  return beams;
}

}  // namespace cairn::agent
