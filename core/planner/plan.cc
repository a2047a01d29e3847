#include "core/planner/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <tuple>
#include <utility>

#include "core/planner/touched_cells.h"

namespace cairn {
namespace {

/// [m] One unit of a field's cost.
constexpr double kCostUnitM = 1e-4;
/// [cells] A closed start is left by no longer way, however fine the map.
constexpr double kMaxLeaveCells = 256;
constexpr const char* kCutOff = "obstacles or steps cut the goal off from here";

Path no_path(std::string why) { return {PathStatus::none, std::move(why), {}, 0.0, 0.0}; }

double cell_m(const DrivableGrid& grid) { return grid.heights.cell_size_mm / 1000.0; }

Eigen::Vector2d middle_m(const DrivableGrid& grid, CellIndex cell) {
  return {(cell.x + 0.5) * cell_m(grid), (cell.y + 0.5) * cell_m(grid)};
}

/// The grid's cell that holds the point, if it has one.
std::optional<CellIndex> cell_at(const DrivableGrid& grid, const Eigen::Vector2d& point_m) {
  if (!(point_m.cwiseAbs().maxCoeff() < HeightMap::kMaxExtentM)) return {};
  const CellIndex cell{static_cast<std::int32_t>(std::floor(point_m.x() / cell_m(grid))),
                       static_cast<std::int32_t>(std::floor(point_m.y() / cell_m(grid)))};
  return grid.heights.contains(cell) ? std::optional(cell) : std::nullopt;
}

/// [cells]
double leave_reach(const DrivableGrid& grid) {
  return std::min(2 * grid.limits.radius_m / cell_m(grid) + 2, kMaxLeaveCells);
}

/// Whether a robot at `start_m`, in a closed cell, can drive straight to an open one: past no
/// obstacle (its own cell may seem one) and no step beyond its limits.
bool can_leave_to(const DrivableGrid& grid, const Eigen::Vector2d& start_m, CellIndex start,
                  CellIndex open) {
  const TouchedCells line(start_m, middle_m(grid, open), cell_m(grid));
  const bool no_obstacle = line.all([&](CellIndex cell) {
    return cell == start || !grid.heights.contains(cell) ||
           grid.classes[grid.heights.at(cell)] != CellClass::obstacle;
  });
  return no_obstacle && steps_within_limits(grid, line);
}

/// Where the way from the start can join the field, nearest first: the start's own cell when it is
/// open, else the open cells that a straight way out leads to.
std::vector<CellIndex> entrances(const DrivableGrid& grid, const Eigen::Vector2d& start_m,
                                 CellIndex start) {
  if (grid.open[grid.heights.at(start)]) return {start};
  const double reach_m = leave_reach(grid) * cell_m(grid);
  const int far = static_cast<int>(leave_reach(grid)) + 1;
  std::vector<std::tuple<double, std::int32_t, std::int32_t>> by_distance;
  for (std::int32_t y = start.y - far; y <= start.y + far; ++y) {
    for (std::int32_t x = start.x - far; x <= start.x + far; ++x) {
      const CellIndex cell{x, y};
      if (!grid.heights.contains(cell) || !grid.open[grid.heights.at(cell)]) continue;
      const double distance_m = (middle_m(grid, cell) - start_m).norm();
      if (distance_m > reach_m || !can_leave_to(grid, start_m, start, cell)) continue;
      by_distance.emplace_back(distance_m, y, x);
    }
  }
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<CellIndex> cells;
  cells.reserve(by_distance.size());
  for (const auto& [distance_m, y, x] : by_distance) cells.push_back({x, y});
  return cells;
}

std::string why_shut_in(const DrivableGrid& grid, CellIndex start) {
  char text[96];
  std::snprintf(text, sizeof text, "no open ground straight within %.2f m of the start, which ",
                leave_reach(grid) * cell_m(grid));
  return text + why_closed(grid, start);
}

/// The first of the entrances from which the field leads to its goal.
std::optional<CellIndex> best_entrance(const Field& field, const DrivableGrid& grid,
                                       const std::vector<CellIndex>& entrances) {
  for (const CellIndex cell : entrances) {
    if (field.cost[grid.heights.at(cell)] != kNoWay) return cell;
  }
  return {};
}

/// Of all cells that can be driven to from the entrances, the one whose middle is nearest the goal.
CellIndex nearest_reachable(const DrivableGrid& grid, const PlannerConfig& config,
                            const std::vector<CellIndex>& entrances,
                            const Eigen::Vector2d& goal_m) {
  const HeightGrid& heights = grid.heights;
  std::vector<bool> reached(grid.open.size());
  std::vector<CellIndex> waiting;
  std::tuple<double, std::int32_t, std::int32_t> nearest{HUGE_VAL, 0, 0};
  const auto reach = [&](CellIndex cell) {
    if (reached[heights.at(cell)]) return;
    reached[heights.at(cell)] = true;
    waiting.push_back(cell);
    nearest = std::min(nearest, {(middle_m(grid, cell) - goal_m).squaredNorm(), cell.y, cell.x});
  };
  for (const CellIndex cell : entrances) reach(cell);
  while (!waiting.empty()) {
    const CellIndex cell = waiting.back();
    waiting.pop_back();
    for (int d = 0; d < 8; ++d) {
      const CellIndex next{cell.x + kStepX[d], cell.y + kStepY[d]};
      if (step_cost(grid, config, heights.at(cell), d) != kNoWay) reach(next);
    }
  }
  return {std::get<2>(nearest), std::get<1>(nearest)};
}

double length_m(const std::vector<Eigen::Vector2d>& points_m) {
  double length = 0.0;
  for (std::size_t i = 1; i < points_m.size(); ++i)
    length += (points_m[i] - points_m[i - 1]).norm();
  return length;
}

/// From the true start into the field at `entrance` and along it to its goal, ending at `end_m`.
Path path_along(const DrivableGrid& grid, const Field& field, CellIndex entrance,
                const PlanRequest& request, const Eigen::Vector2d& end_m) {
  const bool start_is_open = cell_at(grid, request.start_m) == entrance;
  std::vector<Eigen::Vector2d> points_m{request.start_m};
  const std::vector<CellIndex> cells = follow(field, entrance);
  for (std::size_t i = start_is_open ? 1 : 0; i + 1 < cells.size(); ++i) {
    points_m.push_back(middle_m(grid, cells[i]));
  }
  const bool leaves_into_goal_cell = !start_is_open && cells.size() == 1;
  if (leaves_into_goal_cell) points_m.push_back(middle_m(grid, entrance));
  points_m.push_back(end_m);

  Path path;
  path.points_m = simplify(grid, points_m, request.tolerance_m);
  path.length_m = length_m(path.points_m);
  const double leaving_m = start_is_open ? 0.0 : (points_m[1] - request.start_m).norm();
  path.cost_m = leaving_m + field.cost[grid.heights.at(entrance)] * kCostUnitM;
  return path;
}

/// As near to the goal as can be driven. `why` is what keeps the robot from the goal itself.
Path partial_path(const DrivableGrid& grid, const PlannerConfig& config, const PlanRequest& request,
                  const std::vector<CellIndex>& entrances, const std::string& why) {
  const CellIndex end = nearest_reachable(grid, config, entrances, request.goal_m);
  const Result<Field> field = compute_field(grid, end, config);
  const auto entrance = field ? best_entrance(*field, grid, entrances) : std::nullopt;
  if (!entrance) return no_path(why);
  Path path = path_along(grid, *field, *entrance, request, middle_m(grid, end));
  path.status = PathStatus::partial;
  path.why = why;
  return path;
}

}  // namespace

Path plan(const DrivableGrid& grid, const PlanRequest& request, const PlannerConfig& config) {
  if (!request.start_m.allFinite()) return no_path("the start's coordinates are not numbers");
  if (!request.goal_m.allFinite()) return no_path("the goal's coordinates are not numbers");
  const auto start = cell_at(grid, request.start_m);
  if (!start) return no_path("the start lies outside the map");
  const std::vector<CellIndex> ways_in = entrances(grid, request.start_m, *start);
  if (ways_in.empty()) return no_path(why_shut_in(grid, *start));

  const auto goal = cell_at(grid, request.goal_m);
  const std::string closed = goal ? why_closed(grid, *goal) : "lies outside the map";
  std::string why = "the goal " + closed;
  if (closed.empty()) {
    const Field field = compute_field(grid, *goal, config).value();
    if (const auto entrance = best_entrance(field, grid, ways_in)) {
      Path path = path_along(grid, field, *entrance, request, request.goal_m);
      path.status = PathStatus::complete;
      return path;
    }
    why = kCutOff;
  }
  return request.allow_partial ? partial_path(grid, config, request, ways_in, why) : no_path(why);
}

std::vector<CellIndex> follow(const Field& field, CellIndex start) {
  const auto at = [&field](std::int64_t x, std::int64_t y) {
    return static_cast<std::size_t>(y * field.width + x);
  };
  std::int64_t x = std::int64_t{start.x} - field.origin.x;
  std::int64_t y = std::int64_t{start.y} - field.origin.y;
  std::vector<CellIndex> cells;
  while (x >= 0 && y >= 0 && x < field.width && y < field.height &&
         cells.size() < field.direction.size()) {
    cells.push_back({static_cast<std::int32_t>(field.origin.x + x),
                     static_cast<std::int32_t>(field.origin.y + y)});
    const std::uint8_t direction = field.direction[at(x, y)];
    if (direction == Field::kAtGoal) return cells;
    if (direction > 7) return {};
    x += kStepX[direction];
    y += kStepY[direction];
  }
  return {};
}

}  // namespace cairn
