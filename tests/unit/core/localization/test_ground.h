#pragma once

#include <cmath>
#include <limits>
#include <random>

#include "core/localization/registration.h"
#include "tests/support/sampled_ground.h"

namespace cairn::test {

inline constexpr int kCellMm = 125;

/// Rolling ground with boxes on it, different everywhere.
struct RichGround {
  double operator()(double x, double y) const {
    const double hills = 0.3 * std::sin(0.9 * x + 0.3) * std::cos(0.7 * y);
    const bool box = std::sin(1.7 * x + 0.6 * y) + std::sin(2.3 * y - 0.9 * x + 1.0) > 1.2;
    return hills + (box ? 0.4 : 0.0);
  }
};

/// Level ground without a feature.
struct FlatGround {
  double operator()(double, double) const { return 0.0; }
};

/// Two parallel walls along x, seen from inside, and nothing that changes along them.
struct Corridor {
  double operator()(double, double y) const {
    if (std::abs(y) > 1.7) return std::numeric_limits<double>::quiet_NaN();
    return std::abs(y) > 1.5 ? 1.0 : 0.0;
  }
};

template <class Ground>
HeightMap long_term_of(const Ground& ground, std::mt19937_64& random, double known_share = 0.8) {
  return sampled_map(
      ground, Pose{},
      {.half_cells = 120, .hits_per_cell = 8, .noise_m = 0.02, .known_share = known_share}, kCellMm,
      random);
}

template <class Ground>
HeightMap short_term_of(const Ground& ground, const Pose& robot, std::mt19937_64& random) {
  return sampled_map(ground, robot,
                     {.half_cells = 32, .hits_per_cell = 3, .noise_m = 0.02, .known_share = 0.7},
                     kCellMm, random);
}

inline Eigen::Matrix4d sigmas(double position_m, double yaw_rad) {
  const double p2 = position_m * position_m;
  return Eigen::Vector4d(p2, p2, p2, yaw_rad * yaw_rad).asDiagonal();
}

}  // namespace cairn::test
