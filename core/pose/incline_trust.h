#pragma once

#include <Eigen/Core>

#include "core/common/time.h"
#include "core/pose/pose.h"

namespace cairn {

struct InclineTrustConfig {
  /// [rad] Error of roll and pitch while they do not change.
  double incline_sigma_rad = 0.004;
  /// [s] They lag this far behind while they do (T3.2); what is left of it fades at the same pace.
  double incline_lag_s = 0.4;
  /// [m] Beams count no further than to where that error lifts their hits by this much: less than
  /// half a step, so that it makes no obstacles out of slopes.
  double height_sigma_m = 0.06;
};

/// How far the heights that beams tell can be believed: inclinometers lag behind a robot whose
/// incline changes, and then far hits lie too high or too low.
class InclineTrust {
 public:
  explicit InclineTrust(const InclineTrustConfig& config) : config_(config) {}

  /// The robot's pose before and after a motion reading, and the reading's time.
  void note(const Pose& before, const Pose& after, MonotonicTime stamp);
  /// [rad/s] How fast the incline changes.
  [[nodiscard]] double rate_rad_s() const { return rate_rad_s_.norm(); }
  /// [rad] Of roll and pitch, now.
  [[nodiscard]] double sigma_rad() const;
  /// [m] For an incline that is known to `sigma_rad`.
  [[nodiscard]] double range_m(double sigma_rad) const {
    return config_.height_sigma_m / sigma_rad;
  }

 private:
  InclineTrustConfig config_;
  Eigen::Vector2d rate_rad_s_ = Eigen::Vector2d::Zero();  ///< Of roll and pitch, smoothed.
  MonotonicTime last_{};
};

}  // namespace cairn
