#include "robot_agent/pipeline/drift.h"

#include <cmath>

#include "core/common/angle.h"

namespace cairn::agent {

namespace {

/// How much the variance (sigma · total)² grows when `total` grows by `step`.
double growth(double sigma, double total, double step) {
  return sigma * sigma * step * (2.0 * total + step);
}

}  // namespace

void Drift::start(const Eigen::Matrix4d& covariance) {
  covariance_ = covariance;
  way_m_ = 0.0;
  turn_rad_ = 0.0;
}

void Drift::add(const Pose& before, const Pose& after, double dt_s) {
  const Eigen::Vector3d step_m(after.x_m - before.x_m, after.y_m - before.y_m,
                               after.z_m - before.z_m);
  // A wrong yaw carries the step sideways.
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F(0, 3) = -step_m.y();
  F(1, 3) = step_m.x();
  covariance_ = F * covariance_ * F.transpose();
  const double length_m = step_m.norm();
  const double turned_rad = std::abs(wrap_angle(after.yaw_rad - before.yaw_rad));
  if (length_m > 0.0) {
    const Eigen::Vector3d ahead = step_m / length_m;
    covariance_.topLeftCorner<3, 3>() +=
        growth(config_.distance_sigma_per_m, way_m_, length_m) * ahead * ahead.transpose();
    covariance_(2, 2) += growth(config_.incline_sigma_rad, way_m_, length_m);
  }
  covariance_(3, 3) += config_.yaw_sigma_rad_per_sqrt_s * config_.yaw_sigma_rad_per_sqrt_s * dt_s +
                       growth(config_.yaw_sigma_per_rad, turn_rad_, turned_rad);
  way_m_ += length_m;
  turn_rad_ += turned_rad;
}

Eigen::Matrix4d turned(const Eigen::Matrix4d& covariance, double yaw_rad) {
  Eigen::Matrix4d R = Eigen::Matrix4d::Identity();
  R(0, 0) = R(1, 1) = std::cos(yaw_rad);
  R(1, 0) = std::sin(yaw_rad);
  R(0, 1) = -R(1, 0);
  return R * covariance * R.transpose();
}

}  // namespace cairn::agent
