#include "robot_agent/drive/local_view.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cairn::agent {

namespace {

HeightGrid gather(const CellLookup& cells, int cell_size_mm, std::uint8_t min_probability,
                  const Eigen::Vector2d& centre_m, double reach_m) {
  const double cell_m = cell_size_mm / 1000.0;
  const auto reach = static_cast<std::int32_t>(std::ceil(reach_m / cell_m));
  const auto cx = static_cast<std::int32_t>(std::floor(centre_m.x() / cell_m));
  const auto cy = static_cast<std::int32_t>(std::floor(centre_m.y() / cell_m));
  auto grid = empty_grid({cx - reach, cy - reach}, {cx + reach, cy + reach}, cell_size_mm);
  assert(grid && "a window of a few metres is always within bounds");
  copy_known(cells, min_probability, *grid);
  return std::move(*grid);
}

/// Evenly spaced places along a path, the first at its beginning.
std::vector<Eigen::Vector2d> places_along(const std::vector<Eigen::Vector2d>& path_m, double step_m,
                                          double distance_m) {
  std::vector<Eigen::Vector2d> places_m;
  double begin_m = 0.0;  // Way to the beginning of the leg.
  for (std::size_t i = 0; i + 1 < path_m.size() && begin_m <= distance_m; ++i) {
    const Eigen::Vector2d leg = path_m[i + 1] - path_m[i];
    const double end_m = begin_m + leg.norm();
    for (;;) {
      const double way_m = static_cast<double>(places_m.size()) * step_m;
      if (way_m >= end_m || way_m > distance_m) break;
      places_m.push_back(path_m[i] + leg * ((way_m - begin_m) / (end_m - begin_m)));
    }
    begin_m = end_m;
  }
  return places_m;
}

PlannerConfig local_config(const VehicleLimits& limits) {
  PlannerConfig config;
  config.limits = limits;
  config.unknown = UnknownGround::allowed;  // Unseen ground is judged on its own.
  return config;
}

}  // namespace

void copy_known(const CellLookup& cells, std::uint8_t min_probability, HeightGrid& grid) {
  std::size_t at = 0;
  for (std::int32_t y = 0; y < grid.height; ++y) {
    for (std::int32_t x = 0; x < grid.width; ++x, ++at) {
      const Cell cell = cells({grid.origin.x + x, grid.origin.y + y});
      if (cell.probability < min_probability) continue;
      grid.height_mm[at] = cell.height_mm;
      grid.probability[at] = cell.probability;
    }
  }
}

LocalView::LocalView(const CellLookup& cells, int cell_size_mm, std::uint8_t min_probability,
                     const Eigen::Vector2d& centre_m, double reach_m, const VehicleLimits& limits)
    : grid_(make_drivable(gather(cells, cell_size_mm, min_probability, centre_m, reach_m),
                          local_config(limits))),
      radius_m_(limits.radius_m) {}

CellIndex LocalView::cell_at(const Eigen::Vector2d& p_m) const {
  const double cell_m = grid_.heights.cell_size_mm / 1000.0;
  return {static_cast<std::int32_t>(std::floor(p_m.x() / cell_m)),
          static_cast<std::int32_t>(std::floor(p_m.y() / cell_m))};
}

bool LocalView::open_at(const Eigen::Vector2d& p_m) const {
  const CellIndex cell = cell_at(p_m);
  return grid_.heights.contains(cell) && grid_.open[grid_.heights.at(cell)] != 0;
}

bool LocalView::known_at(const Eigen::Vector2d& p_m) const {
  const CellIndex cell = cell_at(p_m);
  return grid_.heights.contains(cell) &&
         grid_.classes[grid_.heights.at(cell)] != CellClass::unknown;
}

double LocalView::height_m(const Eigen::Vector2d& p_m) const {
  return grid_.heights.height_mm[grid_.heights.at(cell_at(p_m))] / 1000.0;
}

Ahead LocalView::look_along(const std::vector<Eigen::Vector2d>& path_m, double distance_m) const {
  const double step_m = grid_.heights.cell_size_mm / 2000.0;
  const std::vector<Eigen::Vector2d> places_m = places_along(path_m, step_m, distance_m);
  const double judged_from_m = places_m.empty() || open_at(places_m.front()) ? 0.0 : radius_m_;
  Ahead ahead{.clear_m = distance_m, .known_m = distance_m, .gap = {}};
  Gap gap;
  std::optional<double> ground_m;  // Height of the last ground seen.
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    const double way_m = static_cast<double>(i) * step_m;
    if (way_m >= judged_from_m && !open_at(places_m[i])) {
      ahead.clear_m = way_m;
      break;
    }
    if (!known_at(places_m[i])) {
      ahead.known_m = std::min(ahead.known_m, way_m);
      if (gap.length_m == 0.0) gap.from_m = way_m;
      gap.length_m += step_m;
      continue;
    }
    const double height_m = this->height_m(places_m[i]);
    if (gap.length_m >= kGapM) {
      if (ground_m) gap.rise_m = std::abs(height_m - *ground_m);
      ahead.gap = gap;
      return ahead;
    }
    gap = {};
    ground_m = height_m;
  }
  if (gap.length_m >= kGapM) ahead.gap = gap;
  return ahead;
}

}  // namespace cairn::agent
