#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "robot_agent/input/height_raster.h"
#include "robot_agent/input/noise.h"

namespace cairn::agent {

/// A rectangle on the ground, turned by yaw around its centre.
struct Rectangle {
  double x_m, y_m;           ///< Centre.
  double length_m, width_m;  ///< Along its own x and y.
  double yaw_rad = 0.0;

  [[nodiscard]] bool contains(double px_m, double py_m) const;
};

/// Sets each node within the bounds to `height(x, y, old height)`.
template <class Height>
void paint(HeightRaster& raster, double west_m, double south_m, double east_m, double north_m,
           Height height) {
  const auto node = [&raster](double from_m, double to_m) {
    return (to_m - from_m) / raster.cell_m();
  };
  const int first_column = std::max(0, static_cast<int>(std::ceil(node(raster.west_m(), west_m))));
  const int first_row = std::max(0, static_cast<int>(std::ceil(node(raster.south_m(), south_m))));
  const int last_column =
      std::min(raster.columns() - 1, static_cast<int>(std::floor(node(raster.west_m(), east_m))));
  const int last_row =
      std::min(raster.rows() - 1, static_cast<int>(std::floor(node(raster.south_m(), north_m))));
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      float& node_m = raster.at(column, row);
      node_m = static_cast<float>(height(raster.x_m(column), raster.y_m(row), double{node_m}));
    }
  }
}

/// The same for all nodes.
template <class Height>
void paint_all(HeightRaster& raster, Height height) {
  paint(raster, raster.west_m(), raster.south_m(), raster.east_m(), raster.north_m(), height);
}

/// The same for the nodes in a rectangle.
template <class Height>
void paint(HeightRaster& raster, const Rectangle& where, Height height) {
  const double reach = 0.5 * std::hypot(where.length_m, where.width_m);
  paint(raster, where.x_m - reach, where.y_m - reach, where.x_m + reach, where.y_m + reach,
        [&](double x, double y, double old) {
          return where.contains(x, y) ? height(x, y, old) : old;
        });
}

/// A solid with vertical sides and a flat top, `height_m` above the ground at its centre; what is
/// higher already stays.
void put_box(HeightRaster& raster, const Rectangle& where, double height_m);
/// The same, round.
void put_cylinder(HeightRaster& raster, double x_m, double y_m, double radius_m, double height_m);
/// A rounded lump, like a rock: an ellipsoid's cap with a rough surface.
void put_rock(HeightRaster& raster, double x_m, double y_m, double radius_m, double height_m,
              Noise& noise);
/// A trunk with a bush around its foot.
void put_tree(HeightRaster& raster, double x_m, double y_m, Noise& noise);

/// Adds uneven ground: independent noise of ± `size_m` at each node.
void roughen(HeightRaster& raster, double size_m, Noise& noise);

/// Smooth random hills: lattice noise of several octaves, each half as wide and half as high as
/// the one before (fractal Brownian motion on value noise). Mean 0.
class Hills {
 public:
  Hills(double wavelength_m, double height_m, int octaves, Noise& noise);
  /// Quickest when called for neighbouring points in turn.
  [[nodiscard]] double height_m(double x_m, double y_m);

 private:
  /// A square between four points of an octave's lattice; the one used last is kept.
  struct Patch {
    bool known = false;
    int column = 0, row = 0;
    double south_west = 0.0, south_east = 0.0, north_west = 0.0, north_east = 0.0;
  };
  struct Octave {
    double wavelength_m, height_m;
    Patch patch;
  };

  [[nodiscard]] const Patch& patch_at(std::size_t octave, int column, int row);
  [[nodiscard]] double lattice(std::size_t octave, int column, int row) const;

  std::uint64_t key_;
  std::vector<Octave> octaves_;
};

}  // namespace cairn::agent
