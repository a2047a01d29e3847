#include "core/planner/touched_cells.h"

#include <cmath>

namespace cairn {
namespace {

/// [cells] See TouchedCells.
constexpr double kTouch = 1e-6;

std::int32_t cell_of(double coordinate) {
  return static_cast<std::int32_t>(std::floor(coordinate));
}

}  // namespace

TouchedCells::TouchedCells(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                           double cell_m)
    : way_(to_m - from_m) {
  const bool eastward = from_m.x() <= to_m.x();
  const Eigen::Vector2d west = (eastward ? from_m : to_m) / cell_m;
  const Eigen::Vector2d east = (eastward ? to_m : from_m) / cell_m;
  const double run = east.x() - west.x();
  const auto row_at = [&](double x) {
    return west.y() + (east.y() - west.y()) * std::clamp((x - west.x()) / run, 0.0, 1.0);
  };
  first_column_ = cell_of(west.x() - kTouch);
  const std::int32_t last_column = cell_of(east.x() + kTouch);
  for (std::int32_t column = first_column_; column <= last_column; ++column) {
    // A line that hardly leaves its column has no slope worth asking for.
    const bool upright = run < kTouch;
    const double y0 = upright ? west.y() : row_at(column - kTouch);
    const double y1 = upright ? east.y() : row_at(column + 1 + kTouch);
    columns_.push_back({cell_of(std::min(y0, y1) - kTouch), cell_of(std::max(y0, y1) + kTouch)});
  }
}

bool steps_within_limits(const DrivableGrid& grid, const TouchedCells& line) {
  const HeightGrid& heights = grid.heights;
  return line.all_steps([&](CellIndex from, CellIndex to) {
    if (!heights.contains(from) || !heights.contains(to)) return true;
    const std::size_t a = heights.at(from);
    const std::size_t b = heights.at(to);
    if (heights.probability[a] == 0 || heights.probability[b] == 0) return true;
    const std::int64_t rise_mm = std::int64_t{heights.height_mm[b]} - heights.height_mm[a];
    return rise_mm <= grid.limits.climb_mm && -rise_mm <= grid.limits.descend_mm;
  });
}

}  // namespace cairn
