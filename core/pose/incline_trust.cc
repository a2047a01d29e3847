#include "core/pose/incline_trust.h"

#include <cmath>
#include <utility>

namespace cairn {

void InclineTrust::note(const Pose& before, const Pose& after, MonotonicTime stamp) {
  const double dt_s = to_seconds(stamp - std::exchange(last_, stamp));
  if (dt_s <= 0.0) return;
  // Signed rates, smoothed: the noise of the readings is no motion.
  const Eigen::Vector2d rate((after.roll_rad - before.roll_rad) / dt_s,
                             (after.pitch_rad - before.pitch_rad) / dt_s);
  rate_rad_s_ += (rate - rate_rad_s_) * (1.0 - std::exp(-dt_s / config_.incline_lag_s));
}

double InclineTrust::sigma_rad() const {
  return config_.incline_sigma_rad + rate_rad_s_.norm() * config_.incline_lag_s;
}

}  // namespace cairn
