#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/common/angle.h"
#include "core/pose/pose.h"

namespace cairn {

/// Position and heading of a level frame: submaps stand upright because gravity is measured, so a
/// pose graph over them has four degrees of freedom, in this order everywhere: x, y, z [m],
/// yaw [rad].
struct LevelPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double yaw_rad = 0.0;  ///< [rad], Limit: (-π, π]
  friend bool operator==(const LevelPose&, const LevelPose&) = default;
};

[[nodiscard]] inline bool is_finite(const LevelPose& p) {
  return std::isfinite(p.x_m) && std::isfinite(p.y_m) && std::isfinite(p.z_m) &&
         std::isfinite(p.yaw_rad);
}

[[nodiscard]] inline LevelPose level(const Pose& pose) {
  return {pose.x_m, pose.y_m, pose.z_m, pose.yaw_rad};
}
[[nodiscard]] inline Pose upright(const LevelPose& pose) {
  return {pose.x_m, pose.y_m, pose.z_m, 0.0, 0.0, pose.yaw_rad};
}

/// T_a_b * T_b_c = T_a_c.
[[nodiscard]] inline LevelPose operator*(const LevelPose& ab, const LevelPose& bc) {
  const double c = std::cos(ab.yaw_rad);
  const double s = std::sin(ab.yaw_rad);
  return {ab.x_m + c * bc.x_m - s * bc.y_m, ab.y_m + s * bc.x_m + c * bc.y_m, ab.z_m + bc.z_m,
          wrap_angle(ab.yaw_rad + bc.yaw_rad)};
}

/// inverse(T_a_b) = T_b_a.
[[nodiscard]] inline LevelPose inverse(const LevelPose& ab) {
  const double c = std::cos(ab.yaw_rad);
  const double s = std::sin(ab.yaw_rad);
  return {-c * ab.x_m - s * ab.y_m, s * ab.x_m - c * ab.y_m, -ab.z_m, wrap_angle(-ab.yaw_rad)};
}

/// T_from_to of two poses in one frame.
[[nodiscard]] inline LevelPose between(const LevelPose& from, const LevelPose& to) {
  return inverse(from) * to;
}

/// Component by component, the yaw wrapped.
[[nodiscard]] inline Eigen::Vector4d difference(const LevelPose& a, const LevelPose& b) {
  return {a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m, wrap_angle(a.yaw_rad - b.yaw_rad)};
}

/// The axes of a frame with this heading, seen from outside; height and heading stay.
[[nodiscard]] inline Eigen::Matrix4d turned_axes(double yaw_rad) {
  Eigen::Matrix4d R = Eigen::Matrix4d::Identity();
  R(0, 0) = R(1, 1) = std::cos(yaw_rad);
  R(1, 0) = std::sin(yaw_rad);
  R(0, 1) = -R(1, 0);
  return R;
}

/// How a point that lies at (x, y) from a frame's origin, seen along the outer axes, moves with the
/// frame: d(point) = lever · d(frame).
[[nodiscard]] inline Eigen::Matrix4d lever(double x_m, double y_m) {
  Eigen::Matrix4d J = Eigen::Matrix4d::Identity();
  J(0, 3) = -y_m;
  J(1, 3) = x_m;
  return J;
}

/// Covariance of T_a_c = T_a_b · T_b_c from those of independent T_a_b and T_b_c, each along the
/// axes of its first frame (Smith, Self and Cheeseman 1990).
[[nodiscard]] inline Eigen::Matrix4d compounded(const LevelPose& ab, const Eigen::Matrix4d& cov_ab,
                                                const LevelPose& bc,
                                                const Eigen::Matrix4d& cov_bc) {
  const LevelPose ac = ab * bc;
  const Eigen::Matrix4d J = lever(ac.x_m - ab.x_m, ac.y_m - ab.y_m);
  const Eigen::Matrix4d R = turned_axes(ab.yaw_rad);
  return J * cov_ab * J.transpose() + R * cov_bc * R.transpose();
}

/// Covariance of inverse(T_a_b).
[[nodiscard]] inline Eigen::Matrix4d inverted(const LevelPose& ab, const Eigen::Matrix4d& cov_ab) {
  const Eigen::Matrix4d J = turned_axes(-ab.yaw_rad) * lever(-ab.x_m, -ab.y_m);
  return J * cov_ab * J.transpose();
}

}  // namespace cairn
