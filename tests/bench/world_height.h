#pragma once

#include <limits>

#include "robot_agent/input/height_raster.h"

namespace cairn::bench {

/// The height of a world at a point of the site [m]; not a number outside of it. Keeps a reference.
class WorldHeight {
 public:
  explicit WorldHeight(const agent::HeightRaster& surface) : surface_(surface) {}

  double operator()(double x_m, double y_m) const {
    const bool inside = x_m > surface_.west_m() && x_m < surface_.east_m() &&
                        y_m > surface_.south_m() && y_m < surface_.north_m();
    return inside ? surface_.height_m(x_m, y_m) : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  const agent::HeightRaster& surface_;
};

}  // namespace cairn::bench
