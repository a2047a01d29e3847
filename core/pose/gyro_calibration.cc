#include "core/pose/gyro_calibration.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cairn {

GyroCalibration::GyroCalibration(const GyroCalibrationConfig& config)
    : config_(config),
      covariance_(Eigen::Vector2d(config.scale_sigma * config.scale_sigma,
                                  config.bias_sigma_rad_s * config.bias_sigma_rad_s)
                      .asDiagonal()) {}

void GyroCalibration::pass(double dt_s) {
  const Eigen::Vector2d walk(config_.scale_walk_per_sqrt_s, config_.bias_walk_rad_s_per_sqrt_s);
  const Eigen::Vector2d prior(config_.scale_sigma, config_.bias_sigma_rad_s);
  for (int i = 0; i < 2; ++i) {
    const double room = std::max(0.0, prior[i] * prior[i] - covariance_(i, i));
    covariance_(i, i) += std::min(walk[i] * walk[i] * dt_s, room);
  }
}

bool GyroCalibration::stood(double reading_rad_s, double dt_s) {
  assert(dt_s > 0.0);
  const double walk = config_.walk_rad_per_sqrt_s;
  return update({0.0, 1.0}, reading_rad_s - bias_rad_s(), walk * walk / dt_s);
}

bool GyroCalibration::missed(double missed_rad, double turned_rad, double time_s,
                             double sigma_rad) {
  const double walk_rad2 = config_.walk_rad_per_sqrt_s * config_.walk_rad_per_sqrt_s * time_s;
  return update({turned_rad, time_s}, -missed_rad, walk_rad2 + sigma_rad * sigma_rad);
}

bool GyroCalibration::update(const Eigen::Vector2d& H, double innovation, double variance) {
  const Eigen::Vector2d shared = covariance_ * H;
  const double S = H.dot(shared) + variance;
  if (!(innovation * innovation <= config_.gate_sigmas * config_.gate_sigmas * S)) return false;
  const Eigen::Vector2d K = shared / S;
  state_ += K * innovation;
  state_[0] = std::clamp(state_[0], -kMaxScale, kMaxScale);
  // Joseph's form keeps it positive.
  const Eigen::Matrix2d left = Eigen::Matrix2d::Identity() - K * H.transpose();
  covariance_ = left * covariance_ * left.transpose() + variance * K * K.transpose();
  return true;
}

double GyroCalibration::sigma_rad(double turned_rad, double time_s) const {
  const Eigen::Vector2d H(turned_rad, time_s);
  const double walk_rad2 = config_.walk_rad_per_sqrt_s * config_.walk_rad_per_sqrt_s * time_s;
  return std::sqrt(H.dot(covariance_ * H) + walk_rad2);
}

}  // namespace cairn
