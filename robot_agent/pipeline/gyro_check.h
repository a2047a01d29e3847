#pragma once

#include <cmath>

#include "core/pose/dead_reckoning.h"

namespace cairn::agent {

/// Whether what local tracking would turn the robot by, all in all since its surfaces were begun,
/// can be the gyro's error. On slopes a level laser that tips by half a degree meets the ground
/// metres further on, sweep after sweep, and tracking takes that for turns of the robot.
class GyroCheck {
 public:
  explicit GyroCheck(const DeadReckoningConfig& config) : config_(config) {}

  /// New surfaces.
  void restart() { turned_rad_ = time_s_ = corrected_rad_ = 0.0; }
  void move(double turned_rad, double dt_s) {
    turned_rad_ += std::abs(turned_rad);
    time_s_ += dt_s;
    if (dt_s > 0.0) rate_rad_s_ = std::abs(turned_rad) / dt_s;
  }
  [[nodiscard]] bool believes(double correction_rad) const {
    constexpr double kSigmas = 3.0;
    constexpr double kLeastRad = 0.004;  // Of a sweep's match.
    constexpr double kApartS = 0.04;     // A sweep and the newest motion reading, one sigma.
    const double apart_rad = kApartS * rate_rad_s_;
    const double scale_rad = config_.yaw_sigma_per_rad * turned_rad_;
    const double wander_rad2 = std::pow(config_.yaw_sigma_rad_per_sqrt_s, 2) * time_s_;
    return std::abs(corrected_rad_ + correction_rad) <=
           kSigmas * std::sqrt(scale_rad * scale_rad + wander_rad2 + kLeastRad * kLeastRad +
                               apart_rad * apart_rad);
  }
  void corrected(double correction_rad) { corrected_rad_ += correction_rad; }

 private:
  DeadReckoningConfig config_;
  double turned_rad_ = 0.0;
  double time_s_ = 0.0;
  double corrected_rad_ = 0.0;
  double rate_rad_s_ = 0.0;
};

}  // namespace cairn::agent
