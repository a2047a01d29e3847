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
  for (std::int32_t y = cy - reach; y <= cy + reach; ++y) {
    for (std::int32_t x = cx - reach; x <= cx + reach; ++x) {
      const Cell cell = cells({x, y});
      if (cell.probability < min_probability) continue;
      grid->height_mm[grid->at({x, y})] = cell.height_mm;
      grid->probability[grid->at({x, y})] = cell.probability;
    }
  }
  return std::move(*grid);
}

PlannerConfig local_config(const VehicleLimits& limits) {
  PlannerConfig config;
  config.limits = limits;
  config.unknown = UnknownGround::allowed;  // Unseen ground is judged on its own.
  return config;
}

}  // namespace

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

Ahead LocalView::look_along(const std::vector<Eigen::Vector2d>& path_m, double distance_m) const {
  const double step_m = grid_.heights.cell_size_mm / 2000.0;
  Ahead ahead{.clear_m = distance_m, .unknown_m = 0.0, .known_m = distance_m};
  const double judged_from_m = path_m.empty() || open_at(path_m.front()) ? 0.0 : radius_m_;
  double way_m = 0.0;
  double unknown_m = 0.0;
  for (std::size_t i = 0; i + 1 < path_m.size(); ++i) {
    const Eigen::Vector2d leg = path_m[i + 1] - path_m[i];
    const int steps = std::max(1, static_cast<int>(std::ceil(leg.norm() / step_m)));
    for (int k = 0; k < steps; ++k) {
      const Eigen::Vector2d p_m = path_m[i] + leg * (static_cast<double>(k) / steps);
      if (way_m > distance_m) return ahead;
      if (way_m >= judged_from_m && !open_at(p_m)) {
        ahead.clear_m = way_m;
        return ahead;
      }
      if (!known_at(p_m)) {
        ahead.known_m = std::min(ahead.known_m, way_m);
        unknown_m += leg.norm() / steps;
        ahead.unknown_m = std::max(ahead.unknown_m, unknown_m);
      } else {
        unknown_m = 0.0;
      }
      way_m += leg.norm() / steps;
    }
  }
  return ahead;
}

}  // namespace cairn::agent
