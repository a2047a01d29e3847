#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "core/map/hidden_steps.h"
#include "core/planner/trulla.h"

namespace cairn {
namespace {

/// Whether two cells that lie (x, y) cells apart are nearer than the radius, middle to middle.
bool within_radius(const DrivableGrid& grid, std::int64_t x, std::int64_t y) {
  const std::int64_t radius_mm = std::llround(grid.limits.radius_m * 1000);
  const std::int64_t cell_mm = grid.heights.cell_size_mm;
  return (x * x + y * y) * cell_mm * cell_mm < radius_mm * radius_mm;
}

/// [cells] No two cells farther apart in x or y are within the radius.
int widest_reach(const DrivableGrid& grid) {
  return static_cast<int>(std::llround(grid.limits.radius_m * 1000) / grid.heights.cell_size_mm);
}

/// [cells] How far an obstacle reaches sideways, by how far above or below it one is. As long as it
/// reaches upwards; empty for radius 0.
std::vector<int> reach_by_distance(const DrivableGrid& grid) {
  std::vector<int> reach;
  int x = widest_reach(grid);
  for (int y = 0; within_radius(grid, 0, y); ++y) {
    while (!within_radius(grid, x, y)) --x;
    reach.push_back(x);
  }
  return reach;
}

std::size_t row_start(const DrivableGrid& grid, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.heights.width);
}

/// `distance[x]` becomes the distance [cells] from row y to the nearest obstacle of column x among
/// the rows passed so far; `far` is as good as none.
void pass_row(const DrivableGrid& grid, int y, std::uint16_t far,
              std::vector<std::uint16_t>& distance) {
  const CellClass* classes = grid.classes.data() + row_start(grid, y);
  for (std::size_t x = 0; x < distance.size(); ++x) {
    const auto farther = static_cast<std::uint16_t>(std::min(distance[x] + 1, int{far}));
    distance[x] = classes[x] == CellClass::obstacle ? std::uint16_t{0} : farther;
  }
}

/// Closes the cells of row y that lie within reach of an obstacle, each column's nearest being
/// `distance` rows away: one sweep for what lies to its right, one for what lies to its left.
void close_row(DrivableGrid& grid, int y, const std::vector<int>& reach,
               const std::vector<std::uint16_t>& distance) {
  std::uint8_t* open = grid.open.data() + row_start(grid, y);
  const int width = grid.heights.width;
  int reached = -1;
  for (int x = 0; x < width; ++x) {
    const std::uint16_t d = distance[static_cast<std::size_t>(x)];
    if (d < reach.size()) reached = std::max(reached, x + reach[d]);
    if (x <= reached) open[x] = 0;
  }
  reached = width;
  for (int x = width - 1; x >= 0; --x) {
    const std::uint16_t d = distance[static_cast<std::size_t>(x)];
    if (d < reach.size()) reached = std::min(reached, x - reach[d]);
    if (x >= reached) open[x] = 0;
  }
}

/// Exact Euclidean clearance in time linear in the cells. As in Felzenszwalb & Huttenlocher 2012
/// columns come first, then rows; as only "nearer than the radius" is asked, the lower envelope of
/// parabolas shrinks to a union of intervals.
void close_near_obstacles(DrivableGrid& grid) {
  const std::vector<int> reach = reach_by_distance(grid);
  if (reach.empty()) return;
  const auto far = static_cast<std::uint16_t>(reach.size());
  std::vector<std::uint16_t> distance(static_cast<std::size_t>(grid.heights.width), far);
  for (int y = 0; y < grid.heights.height; ++y) {
    pass_row(grid, y, far, distance);
    close_row(grid, y, reach, distance);
  }
  std::fill(distance.begin(), distance.end(), far);
  for (int y = grid.heights.height - 1; y >= 0; --y) {
    pass_row(grid, y, far, distance);
    close_row(grid, y, reach, distance);
  }
}

/// [m] From the middle of a cell to the middle of the nearest obstacle within the radius, if any.
std::optional<double> tight_clearance_m(const DrivableGrid& grid, CellIndex cell) {
  const int far = widest_reach(grid);
  std::optional<double> nearest_m;
  for (int dy = -far; dy <= far; ++dy) {
    for (int dx = -far; dx <= far; ++dx) {
      const CellIndex other{cell.x + dx, cell.y + dy};
      if (!within_radius(grid, dx, dy) || !grid.heights.contains(other)) continue;
      if (grid.classes[grid.heights.at(other)] != CellClass::obstacle) continue;
      const double distance_m = std::hypot(dx, dy) * grid.heights.cell_size_mm / 1000.0;
      nearest_m = std::min(nearest_m.value_or(distance_m), distance_m);
    }
  }
  return nearest_m;
}

std::string why_too_near(const DrivableGrid& grid, double clearance_m) {
  char text[96];
  std::snprintf(text, sizeof text,
                "is %.2f m from an obstacle, nearer than the vehicle's radius %.2f m", clearance_m,
                grid.limits.radius_m);
  return text;
}

}  // namespace

DrivableGrid make_drivable(HeightGrid heights, const PlannerConfig& config, WeightLayer weights) {
  DrivableGrid grid{std::move(heights), {}, {}, config.limits, {}, std::move(weights), {}};
  grid.classes = classify(grid.heights, config.limits);
  mark_hidden_steps(grid.heights, config.limits, grid.classes);
  grid.open.resize(grid.classes.size());
  const bool enter_unknown = config.unknown == UnknownGround::allowed;
  std::transform(grid.classes.begin(), grid.classes.end(), grid.open.begin(), [&](CellClass c) {
    return c == CellClass::free || (c == CellClass::unknown && enter_unknown);
  });
  close_near_obstacles(grid);
  price_softly(grid, config);
  price_ground(grid, config, {0, 0, grid.heights.width - 1, grid.heights.height - 1});
  return grid;
}

std::string why_closed(const DrivableGrid& grid, CellIndex cell) {
  if (!grid.heights.contains(cell)) return "lies outside the map";
  const std::size_t at = grid.heights.at(cell);
  if (grid.open[at]) return {};
  if (grid.classes[at] == CellClass::obstacle) return "is on an obstacle";
  if (const auto clearance_m = tight_clearance_m(grid, cell)) {
    return why_too_near(grid, *clearance_m);
  }
  return "is on ground nobody has seen: allow unknown ground or pick another";
}

}  // namespace cairn
