#include "robot_agent/input/ray_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cairn::agent {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// [m] Carries the ray over the border it has reached, well below what any laser resolves.
constexpr double kNudgeM = 1e-6;
// A slope too small to cross a border within any range; as 0 it cannot be caught on one either.
constexpr double kNoSlope = 1e-9;

double without_crawl(double slope) { return std::abs(slope) < kNoSlope ? 0.0 : slope; }

double range_to_border(double position, double slope, double low, double high) {
  if (slope > 0.0) {
    return (high - position) / slope;
  }
  return slope < 0.0 ? (low - position) / slope : kInfinity;
}

// The smallest root of a·t² + b·t + c in [0, end], for c > 0.
std::optional<double> first_root(double a, double b, double c, double end) {
  double root = kInfinity;
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant >= 0.0) {
    // Both roots without cancellation.
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    for (const double t : {q / a, c / q}) {
      root = t >= 0.0 ? std::min(root, t) : root;
    }
  }
  return root <= end ? std::optional(root) : std::nullopt;
}

}  // namespace

// In units of cells horizontally (u, v), metres vertically; slopes per metre of range.
struct RayCaster::Ray {
  double u, v, z;
  double du, dv, dz;

  [[nodiscard]] double u_at(double range_m) const { return u + du * range_m; }
  [[nodiscard]] double v_at(double range_m) const { return v + dv * range_m; }
  [[nodiscard]] double z_at(double range_m) const { return z + dz * range_m; }

  // Range at which the ray leaves the square of `cells` that it is in, or the raster.
  [[nodiscard]] double leaves(const HeightRaster& surface, int column, int row, int cells) const {
    const int west = column * cells;
    const int south = row * cells;
    const int east = std::min(west + cells, surface.columns() - 1);
    const int north = std::min(south + cells, surface.rows() - 1);
    return std::min(range_to_border(u, du, west, east), range_to_border(v, dv, south, north));
  }

  // Range in [from, to] at which it meets the surface of one cell.
  [[nodiscard]] std::optional<double> meets(const HeightRaster& surface, int column, int row,
                                            double from_m, double to_m) const {
    const double h00 = surface.at(column, row);
    const double h10 = surface.at(column + 1, row) - h00;
    const double h01 = surface.at(column, row + 1) - h00;
    const double h11 = surface.at(column + 1, row + 1) - h00 - h10 - h01;
    const double fu = u_at(from_m) - column;
    const double fv = v_at(from_m) - row;
    // z - h along the ray, with h = h00 + h10·fu + h01·fv + h11·fu·fv.
    const double c = z_at(from_m) - (h00 + h10 * fu + h01 * fv + h11 * fu * fv);
    if (c <= 0.0) {
      return from_m;
    }
    const double b = dz - h10 * du - h01 * dv - h11 * (fu * dv + fv * du);
    const double a = -h11 * du * dv;
    const auto root = first_root(a, b, c, to_m - from_m);
    return root ? std::optional(from_m + *root) : std::nullopt;
  }
};

RayCaster::RayCaster(const HeightRaster& surface)
    : surface_(surface),
      levels_{highest_points(surface, 64), highest_points(surface, 8), highest_points(surface, 1)} {
}

RayCaster::Blocks RayCaster::highest_points(const HeightRaster& surface, int cells) {
  const auto blocks = [cells](int nodes) { return (nodes - 2) / cells + 1; };
  Blocks result{cells, blocks(surface.columns()), {}};
  const int rows = blocks(surface.rows());
  result.highest_m.reserve(static_cast<std::size_t>(result.columns) *
                           static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    const int north = std::min((row + 1) * cells, surface.rows() - 1);
    for (int column = 0; column < result.columns; ++column) {
      const int east = std::min((column + 1) * cells, surface.columns() - 1);
      float highest = -std::numeric_limits<float>::infinity();
      for (int r = row * cells; r <= north; ++r) {
        for (int c = column * cells; c <= east; ++c) {
          highest = std::max(highest, surface.at(c, r));
        }
      }
      result.highest_m.push_back(highest);
    }
  }
  return result;
}

double RayCaster::skip(const Ray& ray, const Blocks& blocks, double from_m) const {
  const int column = static_cast<int>(ray.u_at(from_m)) / blocks.cells;
  const int row = static_cast<int>(ray.v_at(from_m)) / blocks.cells;
  const double to_m = ray.leaves(surface_, column, row, blocks.cells);
  const auto block = static_cast<std::size_t>(row) * static_cast<std::size_t>(blocks.columns) +
                     static_cast<std::size_t>(column);
  const double lowest = std::min(ray.z_at(from_m), ray.z_at(to_m));
  return lowest > double{blocks.highest_m[block]} ? to_m : from_m;
}

double RayCaster::range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                          double max_range_m) const {
  const double cell = surface_.cell_m();
  const Ray ray{(origin.x() - surface_.west_m()) / cell,
                (origin.y() - surface_.south_m()) / cell,
                origin.z(),
                without_crawl(direction.x() / cell),
                without_crawl(direction.y() / cell),
                direction.z()};
  const int last_column = surface_.columns() - 2;
  const int last_row = surface_.rows() - 2;
  double range = 0.0;
  while (range < max_range_m) {
    const double u = ray.u_at(range);
    const double v = ray.v_at(range);
    if (!(u >= 0.0 && v >= 0.0 && u < last_column + 1 && v < last_row + 1)) {
      return range;  // The wall around the raster.
    }
    double next = range;
    for (const Blocks& blocks : levels_) {
      next = skip(ray, blocks, range);
      if (next > range) {
        break;
      }
    }
    if (next <= range) {
      const int column = static_cast<int>(u);
      const int row = static_cast<int>(v);
      next = ray.leaves(surface_, column, row, 1);
      if (const auto hit = ray.meets(surface_, column, row, range, std::max(next, range))) {
        return std::min(*hit, max_range_m);
      }
    }
    range = std::max(range, next) + kNudgeM;
  }
  return max_range_m;
}

}  // namespace cairn::agent
