#pragma once

#include <cmath>

#include "core/pose/dead_reckoning.h"

namespace cairn::agent {

/// Whether what local tracking would turn the robot by, all in all in a while, can be the gyro's
/// error. On slopes a level laser that tips by half a degree meets the ground metres further on,
/// sweep after sweep, and tracking takes that for turns of the robot. What it believes is what the
/// gyro learns from.
class GyroCheck {
 public:
  /// [s] After this long the gyro is compared, and the check begins anew.
  static constexpr double kWhileS = 10.0;
  static constexpr double kTrackingSigmaRad = 0.003;  ///< Of a tracked heading.

  void move(double turned_rad, double dt_s) {
    turned_rad_ += turned_rad;
    turns_rad_ += std::abs(turned_rad);
    time_s_ += dt_s;
    if (dt_s > 0.0) rate_rad_s_ = std::abs(turned_rad) / dt_s;
  }
  [[nodiscard]] bool believes(double correction_rad, const GyroCalibration& gyro) const {
    constexpr double kSigmas = 3.0;
    constexpr double kLeastRad = 0.004;  // Of a sweep's match.
    constexpr double kApartS = 0.04;     // A sweep and the newest motion reading, one sigma.
    constexpr double kUneven = 0.005;    // Of turns to and fro.
    const double sigma_rad =
        std::hypot(gyro.sigma_rad(turned_rad_, time_s_),
                   std::hypot(kLeastRad, kUneven * turns_rad_), kApartS * rate_rad_s_);
    return std::abs(corrected_rad_ + correction_rad) <= kSigmas * sigma_rad;
  }
  void corrected(double correction_rad) {
    corrected_rad_ += correction_rad;
    ++corrections_;
  }
  /// Turns are not tracked for a while.
  void interrupt() { interrupted_ = true; }

  [[nodiscard]] bool due() const { return time_s_ >= kWhileS; }
  /// The while is over. If the robot was tracked all along, the gyro learns from it.
  void conclude(DeadReckoning& dead_reckoning) {
    constexpr int kFewest = 10;  // Corrections.
    if (!interrupted_ && corrections_ >= kFewest) {
      dead_reckoning.learn(corrected_rad_, turned_rad_, time_s_, kTrackingSigmaRad);
    }
    *this = {};
  }

 private:
  double turned_rad_ = 0.0;  ///< Left and right make none.
  double turns_rad_ = 0.0;   ///< They add up.
  double time_s_ = 0.0;
  double corrected_rad_ = 0.0;
  double rate_rad_s_ = 0.0;
  int corrections_ = 0;
  bool interrupted_ = false;
};

}  // namespace cairn::agent
