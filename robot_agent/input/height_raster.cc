#include "robot_agent/input/height_raster.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cairn::agent {

HeightRaster::HeightRaster(double cell_m, int columns, int rows, double west_m, double south_m)
    : cell_m_(cell_m), columns_(columns), rows_(rows), west_m_(west_m), south_m_(south_m) {
  assert(cell_m > 0 && columns >= 2 && rows >= 2);
  const auto nodes = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  assert(nodes <= kMaxNodes);
  heights_m_.resize(nodes, 0.0F);
}

double HeightRaster::height_m(double x_m, double y_m) const {
  const double u = (x_m - west_m_) / cell_m_;
  const double v = (y_m - south_m_) / cell_m_;
  if (!(u >= 0.0 && v >= 0.0 && u <= columns_ - 1 && v <= rows_ - 1)) {
    return kOutside;
  }
  const int column = std::min(static_cast<int>(u), columns_ - 2);
  const int row = std::min(static_cast<int>(v), rows_ - 2);
  const double fu = u - column;
  const double fv = v - row;
  const double south = std::lerp(double{at(column, row)}, double{at(column + 1, row)}, fu);
  const double north = std::lerp(double{at(column, row + 1)}, double{at(column + 1, row + 1)}, fu);
  return std::lerp(south, north, fv);
}

void HeightRaster::raise(double by_m) {
  for (float& height : heights_m_) {
    height = static_cast<float>(height + by_m);
  }
}

}  // namespace cairn::agent
