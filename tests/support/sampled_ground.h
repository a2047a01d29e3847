#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "core/map/height_map.h"
#include "core/pose/pose.h"

namespace cairn::test {

/// How a map is made of a ground whose height is known everywhere.
struct Sampling {
  int half_cells = 64;       ///< The map is a square of twice this.
  int hits_per_cell = 4;     ///< Its height is their mean.
  double noise_m = 0.02;     ///< Standard deviation of one hit's height.
  double known_share = 0.8;  ///< The rest is hidden by discs of 0.4 to 1.2 m.
  bool fan = false;          ///< Only what a sensor that looks 270° around x > 0 sees.
};

/// Discs that hide parts of a map, in its frame.
class Hidden {
 public:
  Hidden(const Sampling& sampling, double cell_m, std::mt19937_64& random) {
    const double half_m = sampling.half_cells * cell_m;
    constexpr double kMeanDiscM2 = 2.18;  // Mean of π r² for r in [0.4, 1.2].
    const double discs = -std::log(sampling.known_share) * 4.0 * half_m * half_m / kMeanDiscM2;
    std::uniform_real_distribution<double> place(-half_m, half_m);
    std::uniform_real_distribution<double> radius(0.4, 1.2);
    for (int i = 0; i < static_cast<int>(discs); ++i) {
      const double x = place(random);
      const double y = place(random);
      discs_.push_back({x, y, radius(random)});
    }
  }

  [[nodiscard]] bool holds(double x, double y) const {
    for (const Disc& disc : discs_) {
      if (std::hypot(x - disc.x, y - disc.y) < disc.r) return true;
    }
    return false;
  }

 private:
  struct Disc {
    double x, y, r;
  };
  std::vector<Disc> discs_;
};

/// A map in the frame T_site_map (level) of a ground `height_m(x, y)` in the site; where that is
/// not a number nothing is known.
template <class Height>
HeightMap sampled_map(const Height& height_m, const Pose& T_site_map, const Sampling& sampling,
                      int cell_size_mm, std::mt19937_64& random) {
  HeightMap map(cell_size_mm);
  const double cell_m = map.cell_size_m();
  const Hidden hidden(sampling, cell_m, random);
  const double c = std::cos(T_site_map.yaw_rad);
  const double s = std::sin(T_site_map.yaw_rad);
  std::uniform_real_distribution<double> in_cell(0.0, cell_m);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (std::int32_t j = -sampling.half_cells; j < sampling.half_cells; ++j) {
    for (std::int32_t i = -sampling.half_cells; i < sampling.half_cells; ++i) {
      const double x = map.centre_m(i);
      const double y = map.centre_m(j);
      if (sampling.fan && std::abs(std::atan2(y, x)) > 0.75 * std::numbers::pi) continue;
      if (hidden.holds(x, y)) continue;
      double sum = 0.0;
      for (int hit = 0; hit < sampling.hits_per_cell; ++hit) {
        const double u = i * cell_m + in_cell(random);
        const double v = j * cell_m + in_cell(random);
        sum += height_m(T_site_map.x_m + c * u - s * v, T_site_map.y_m + s * u + c * v) +
               sampling.noise_m * noise(random);
      }
      const double height = sum / sampling.hits_per_cell - T_site_map.z_m;
      if (!std::isfinite(height)) continue;
      map.set({i, j}, {static_cast<std::int32_t>(std::lround(height * 1000.0)), 200});
    }
  }
  return map;
}

}  // namespace cairn::test
