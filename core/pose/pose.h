#pragma once

#include <Eigen/Geometry>

namespace cairn {

/// Position and orientation in space (T3.3). The rotation is Rot(z, yaw) · Rot(y, pitch) ·
/// Rot(x, roll) (T Eq. 7). Frames are right-handed with z up and x forward, so a *positive pitch
/// lowers the nose*: driving up a 30° slope is pitch = -30°.
struct Pose {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double roll_rad = 0.0;   ///< [rad], Limit: (-π, π]
  double pitch_rad = 0.0;  ///< [rad], Limit: [-π/2, π/2]
  double yaw_rad = 0.0;    ///< [rad], Limit: (-π, π]
};

/// T = Trans(x, y, z) · Rot(z, yaw) · Rot(y, pitch) · Rot(x, roll)  (T Eq. 7, 9, 10).
[[nodiscard]] Eigen::Isometry3d to_transform(const Pose& pose);

/// The inverse of `to_transform`; at pitch = ±90° the roll is chosen as 0.
[[nodiscard]] Pose from_transform(const Eigen::Isometry3d& T);

/// False when any component is not a finite number.
[[nodiscard]] bool is_finite(const Pose& pose);

}  // namespace cairn
