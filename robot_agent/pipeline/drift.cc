#include "robot_agent/pipeline/drift.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/common/angle.h"

namespace cairn::agent {

namespace {

/// [-] A step against surfaces that were there before adds hardly any error; what is new among them
/// does: about every fifth step's worth.
constexpr double kNewSurface = 5.0;
constexpr double kCorridorM = 10.0;
/// [rad/√m] What untracked heading wanders.
constexpr double kYawSigmaPerSqrtM = 0.01;

/// How much the variance (sigma · total)² grows when `total` grows by `step`.
double growth(double sigma, double total, double step) {
  return sigma * sigma * step * (2.0 * total + step);
}

/// A wrong yaw carries the step sideways.
Eigen::Matrix4d carried(const Eigen::Matrix4d& covariance, const Pose& from, const Pose& to) {
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F(0, 3) = -(to.y_m - from.y_m);
  F(1, 3) = to.x_m - from.x_m;
  return F * covariance * F.transpose();
}

}  // namespace

void Drift::start(const Eigen::Matrix4d& covariance) {
  covariance_ = covariance;
  kept_covariance_ = covariance;
  T_local_kept_.reset();
  way_m_ = 0.0;
  turn_rad_ = 0.0;
  kept_way_m_ = 0.0;
  kept_turn_rad_ = 0.0;
}

void Drift::add(const Pose& before, const Pose& after, double dt_s) {
  if (!T_local_kept_) T_local_kept_ = before;
  const Eigen::Vector3d step_m(after.x_m - before.x_m, after.y_m - before.y_m,
                               after.z_m - before.z_m);
  covariance_ = carried(covariance_, before, after);
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
  kept_way_m_ += length_m;
  kept_turn_rad_ += turned_rad;
}

void Drift::track(const Pose& T_local_robot, const Eigen::Matrix3d& information, bool kept) {
  const double z_m2 = covariance_(2, 2);
  covariance_ = carried(kept_covariance_, T_local_kept_.value_or(T_local_robot), T_local_robot);
  const Eigen::Matrix3d step = (kNewSurface * information + untracked().inverse().eval()).inverse();
  constexpr std::array kPlanar{0, 1, 3};
  for (std::size_t i = 0; i < kPlanar.size(); ++i) {
    for (std::size_t j = 0; j < kPlanar.size(); ++j) {
      covariance_(kPlanar[i], kPlanar[j]) +=
          step(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  covariance_(2, 2) = z_m2;
  turn_rad_ = 0.0;
  if (!kept) return;
  kept_covariance_ = covariance_;
  T_local_kept_ = T_local_robot;
  kept_way_m_ = 0.0;
  kept_turn_rad_ = 0.0;
}

/// What the way since the last kept place may be off by where no surface tells: as much as makes
/// up slip and gyro scale over the length of a corridor.
Eigen::Matrix3d Drift::untracked() const {
  const double m2 = std::pow(config_.distance_sigma_per_m, 2) * kCorridorM * kept_way_m_ + 1e-6;
  const double rad2 = std::pow(config_.yaw_sigma_per_rad, 2) * std::numbers::pi * kept_turn_rad_ +
                      std::pow(kYawSigmaPerSqrtM, 2) * kept_way_m_ + 1e-8;
  return Eigen::Vector3d(m2, m2, rad2).asDiagonal();
}

Eigen::Matrix4d turned(const Eigen::Matrix4d& covariance, double yaw_rad) {
  Eigen::Matrix4d R = Eigen::Matrix4d::Identity();
  R(0, 0) = R(1, 1) = std::cos(yaw_rad);
  R(1, 0) = std::sin(yaw_rad);
  R(0, 1) = -R(1, 0);
  return R * covariance * R.transpose();
}

}  // namespace cairn::agent
