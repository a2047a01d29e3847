#include "robot_agent/input/paint.h"

#include <numbers>

namespace cairn::agent {

bool Rectangle::contains(double px_m, double py_m) const {
  const double dx = px_m - x_m;
  const double dy = py_m - y_m;
  const double along = std::cos(yaw_rad) * dx + std::sin(yaw_rad) * dy;
  const double across = -std::sin(yaw_rad) * dx + std::cos(yaw_rad) * dy;
  return std::abs(along) <= 0.5 * length_m && std::abs(across) <= 0.5 * width_m;
}

void put_box(HeightRaster& raster, const Rectangle& where, double height_m) {
  const double top = raster.height_m(where.x_m, where.y_m) + height_m;
  paint(raster, where, [top](double, double, double old) { return std::max(old, top); });
}

void put_cylinder(HeightRaster& raster, double x_m, double y_m, double radius_m, double height_m) {
  const double top = raster.height_m(x_m, y_m) + height_m;
  paint(raster, x_m - radius_m, y_m - radius_m, x_m + radius_m, y_m + radius_m,
        [&](double x, double y, double old) {
          return std::hypot(x - x_m, y - y_m) <= radius_m ? std::max(old, top) : old;
        });
}

void put_rock(HeightRaster& raster, double x_m, double y_m, double radius_m, double height_m,
              Noise& noise) {
  const double squeeze = noise.uniform(0.6, 1.0);
  const double turn = noise.uniform(0.0, std::numbers::pi);
  paint(raster, x_m - radius_m, y_m - radius_m, x_m + radius_m, y_m + radius_m,
        [&](double x, double y, double old) {
          const double dx = std::cos(turn) * (x - x_m) + std::sin(turn) * (y - y_m);
          const double dy = -std::sin(turn) * (x - x_m) + std::cos(turn) * (y - y_m);
          const double off = std::hypot(dx, dy / squeeze) / radius_m;
          const double lump = std::sqrt(std::max(0.0, 1.0 - off * off));
          return old + height_m * lump * (1.0 + 0.05 * noise.normal());
        });
}

void put_tree(HeightRaster& raster, double x_m, double y_m, Noise& noise) {
  if (noise.uniform() < 0.4) {
    put_rock(raster, x_m, y_m, noise.uniform(0.4, 0.8), noise.uniform(0.3, 0.7), noise);
  }
  put_cylinder(raster, x_m, y_m, noise.uniform(0.1, 0.3), noise.uniform(4.0, 9.0));
}

void roughen(HeightRaster& raster, double size_m, Noise& noise) {
  paint_all(raster,
            [&](double, double, double old) { return old + noise.uniform(-size_m, size_m); });
}

Hills::Hills(double wavelength_m, double height_m, int octaves, Noise& noise)
    : key_(static_cast<std::uint64_t>(noise.uniform() * 0x1.0p53)) {
  for (int i = 0; i < octaves; ++i) {
    octaves_.push_back({wavelength_m * std::exp2(-i), height_m * std::exp2(-i), {}});
  }
}

double Hills::height_m(double x_m, double y_m) {
  const auto smooth = [](double t) { return t * t * t * (t * (6.0 * t - 15.0) + 10.0); };
  double sum = 0.0;
  for (std::size_t i = 0; i < octaves_.size(); ++i) {
    Octave& octave = octaves_[i];
    const double u = x_m / octave.wavelength_m;
    const double v = y_m / octave.wavelength_m;
    const Patch& patch =
        patch_at(i, static_cast<int>(std::floor(u)), static_cast<int>(std::floor(v)));
    const double fu = smooth(u - patch.column);
    const double south = patch.south_west + fu * (patch.south_east - patch.south_west);
    const double north = patch.north_west + fu * (patch.north_east - patch.north_west);
    sum += octave.height_m * (south + smooth(v - patch.row) * (north - south));
  }
  return sum;
}

const Hills::Patch& Hills::patch_at(std::size_t octave, int column, int row) {
  Patch& patch = octaves_[octave].patch;
  if (!patch.known || patch.column != column || patch.row != row) {
    patch = {true,
             column,
             row,
             lattice(octave, column, row),
             lattice(octave, column + 1, row),
             lattice(octave, column, row + 1),
             lattice(octave, column + 1, row + 1)};
  }
  return patch;
}

// In [-1, 1).
double Hills::lattice(std::size_t octave, int column, int row) const {
  std::uint64_t z = key_ + octave * 0x9E3779B97F4A7C15U;
  z = Noise::mix(z ^ static_cast<std::uint32_t>(column));
  z = Noise::mix(z * 0x9E3779B97F4A7C15U ^ static_cast<std::uint32_t>(row));
  return static_cast<double>(z >> 11U) * 0x1.0p-52 - 1.0;
}

}  // namespace cairn::agent
