#pragma once

#include <cmath>
#include <numbers>

namespace cairn {

[[nodiscard]] constexpr double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}
[[nodiscard]] constexpr double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

/// The same direction in (-π, π].
[[nodiscard]] inline double wrap_angle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

}  // namespace cairn
