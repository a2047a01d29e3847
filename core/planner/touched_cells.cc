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
  west_ = (eastward ? from_m : to_m) / cell_m;
  east_ = (eastward ? to_m : from_m) / cell_m;
  first_column_ = cell_of(west_.x() - kTouch);
  last_column_ = cell_of(east_.x() + kTouch);
}

TouchedCells::Rows TouchedCells::rows_of(std::int32_t column) const {
  const double run = east_.x() - west_.x();
  const auto row_at = [&](double x) {
    return west_.y() + (east_.y() - west_.y()) * std::clamp((x - west_.x()) / run, 0.0, 1.0);
  };
  // A line that hardly leaves its column has no slope worth asking for.
  const bool upright = run < kTouch;
  const double y0 = upright ? west_.y() : row_at(column - kTouch);
  const double y1 = upright ? east_.y() : row_at(column + 1 + kTouch);
  return {cell_of(std::min(y0, y1) - kTouch), cell_of(std::max(y0, y1) + kTouch)};
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
