#include "core/planner/plan.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <optional>
#include <tuple>
#include <utility>

#include "core/planner/field_walk.h"
#include "core/planner/tighten.h"
#include "core/planner/touched_cells.h"

namespace cairn {
namespace {

/// [cells] A closed start is left by no longer way, however fine the map.
constexpr double kMaxLeaveCells = 256;
constexpr const char* kCutOff = "obstacles or steps cut the goal off from here";

Path no_path(std::string why) { return {PathStatus::none, std::move(why), {}, 0.0, 0.0, {}}; }

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

std::string shut_in_at(const DrivableGrid& grid, CellIndex start) {
  char text[96];
  std::snprintf(text, sizeof text, "no open ground straight within %.2f m of the start, which ",
                leave_reach(grid) * cell_m(grid));
  return text + why_closed(grid, start);
}

/// The first of the entrances from which the field leads to its goal.
std::optional<CellIndex> best_entrance(const Field& field, const DrivableGrid& grid,
                                       const std::vector<CellIndex>& entrances) {
  for (const CellIndex cell : entrances) {
    if (cost_to_goal(grid, field, cell) != kNoWay) return cell;
  }
  return {};
}

/// Of all cells that can be driven to from the entrances, the one whose middle is nearest the goal.
CellIndex nearest_reachable(const DrivableGrid& grid, const std::vector<CellIndex>& entrances,
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
      if (step_cost(grid, cell, d) != kNoWay) reach(next);
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

using Points = std::vector<Eigen::Vector2d>;

/// From the true start over the cells' middles to the end: the first and last middles lie in the
/// cells of the start and the end, which stand for them.
Points over_middles(const DrivableGrid& grid, const std::vector<CellIndex>& cells,
                    const Eigen::Vector2d& start_m, const Eigen::Vector2d& end_m) {
  Points points_m{start_m};
  for (std::size_t i = 1; i + 1 < cells.size(); ++i) points_m.push_back(middle_m(grid, cells[i]));
  points_m.push_back(end_m);
  return points_m;
}

/// [cost units] No way over cells is cheaper than this: the field says so of those between the
/// middles, and the ends lie no farther from those than this says.
double least_over_cells(const DrivableGrid& grid, const Field& field, CellIndex entrance,
                        const Eigen::Vector2d& start_m, const Eigen::Vector2d& end_m) {
  const double beside_m =
      (start_m - middle_m(grid, entrance)).norm() + (end_m - middle_m(grid, field.goal)).norm();
  return field.levelled[grid.ground_at(entrance)] - beside_m / grid.unit_m();
}

/// The cheaper of two ways, which have the same ends.
const Points& cheaper(const LineCost& lines, const Points& a, const Points& b) {
  return cost_along(lines, b) < cost_along(lines, a) ? b : a;
}

/// The best way down the field from `start_m`, which lies in the reached cell `entrance`, to
/// `end_m` in the goal's. Never dearer than the cheapest way in steps from cell to cell.
Points way_down(const DrivableGrid& grid, const Field& field, CellIndex entrance,
                const Eigen::Vector2d& start_m, const Eigen::Vector2d& end_m) {
  const LineCost lines(grid);
  const auto over = [&](const std::vector<CellIndex>& cells) {
    return tighten(lines, over_middles(grid, cells, start_m, end_m));
  };
  Points best_m = over(cells_down(grid, field, entrance));
  const Points walked_m = walk_down(grid, field, lines, start_m, end_m);
  if (!walked_m.empty()) best_m = cheaper(lines, best_m, tighten(lines, walked_m));
  const double cost = cost_along(lines, best_m);
  if (cost <= least_over_cells(grid, field, entrance, start_m, end_m)) return best_m;
  const std::vector<CellIndex> cells = cheapest_cells(grid, field, entrance, cost + 2 * kCellUnits);
  return cells.empty() ? best_m : cheaper(lines, best_m, over(cells));
}

/// From the true start into the field at `entrance` and along it to its goal, ending at `end_m`.
Path path_along(const DrivableGrid& grid, const Field& field, CellIndex entrance,
                const PlanRequest& request, const Eigen::Vector2d& end_m) {
  const bool start_is_open = cell_at(grid, request.start_m) == entrance;
  const Eigen::Vector2d first_m = start_is_open ? request.start_m : middle_m(grid, entrance);
  Points points_m = way_down(grid, field, entrance, first_m, end_m);
  if (!start_is_open) points_m.insert(points_m.begin(), request.start_m);

  Path path;
  path.points_m = simplify(grid, points_m, request.tolerance_m);
  path.length_m = length_m(path.points_m);
  const double leaving_m = start_is_open ? 0.0 : (points_m[1] - request.start_m).norm();
  path.cost_m = leaving_m + cost_to_goal(grid, field, entrance) * grid.unit_m();
  return path;
}

/// To a cell that can be reached. `why` is what keeps the robot from the goal itself.
Path partial_path(const DrivableGrid& grid, CellIndex end, const PlanRequest& request,
                  const std::vector<CellIndex>& entrances, const std::string& why) {
  const Result<Field> field = compute_field(grid, end);
  const auto entrance = field ? best_entrance(*field, grid, entrances) : std::nullopt;
  if (!entrance) return no_path(why);
  Path path = path_along(grid, *field, *entrance, request, middle_m(grid, end));
  path.status = PathStatus::partial;
  path.why = why;
  return path;
}

/// The last open cell on the best way over ground that nobody has seen, if there is such a way.
std::optional<CellIndex> opening_frontier(const DrivableGrid& grid, CellIndex goal,
                                          PlannerConfig config,
                                          const std::vector<CellIndex>& entrances) {
  config.unknown = UnknownGround::allowed;
  const DrivableGrid all = make_drivable(grid.heights, config);
  const Result<Field> field = compute_field(all, goal);
  const auto entrance = field ? best_entrance(*field, all, entrances) : std::nullopt;
  if (!entrance) return {};
  CellIndex last = *entrance;
  for (const CellIndex cell : cells_down(all, *field, *entrance)) {
    if (!grid.open[grid.heights.at(cell)]) break;
    last = cell;
  }
  return last;
}

std::string why_explore(const std::string& why, const Eigen::Vector2d& frontier_m) {
  char text[96];
  std::snprintf(text, sizeof text, "; exploring from (%.2f, %.2f) m on might open a way",
                frontier_m.x(), frontier_m.y());
  return why + text;
}

/// What there is to offer where `why` keeps the robot from the goal.
Path second_best(const DrivableGrid& grid, const PlannerConfig& config, const PlanRequest& request,
                 const std::vector<CellIndex>& entrances, std::string why) {
  const auto goal = cell_at(grid, request.goal_m);
  const auto frontier = config.unknown == UnknownGround::explore && goal
                            ? opening_frontier(grid, *goal, config, entrances)
                            : std::nullopt;
  if (frontier) why = why_explore(why, middle_m(grid, *frontier));
  Path path = no_path(why);
  if (request.allow_partial) {
    const CellIndex end = frontier ? *frontier : nearest_reachable(grid, entrances, request.goal_m);
    path = partial_path(grid, end, request, entrances, why);
  }
  if (frontier) path.frontier_m = middle_m(grid, *frontier);
  return path;
}

/// `find_field` gives the field to a goal that is open, when it is needed.
template <class FindField>
Path plan_with(const DrivableGrid& grid, const PlanRequest& request, const PlannerConfig& config,
               FindField&& find_field) {
  if (!request.start_m.allFinite()) return no_path("the start's coordinates are not numbers");
  if (!request.goal_m.allFinite()) return no_path("the goal's coordinates are not numbers");
  const auto start = cell_at(grid, request.start_m);
  if (!start) return no_path("the start lies outside the map");
  const std::vector<CellIndex> ways_in = entrances(grid, request.start_m, *start);
  if (ways_in.empty()) return no_path(shut_in_at(grid, *start));

  const auto goal = cell_at(grid, request.goal_m);
  const std::string closed = goal ? why_closed(grid, *goal) : "lies outside the map";
  std::string why = "the goal " + closed;
  if (closed.empty()) {
    const Field& field = find_field(*goal);
    if (const auto entrance = best_entrance(field, grid, ways_in)) {
      Path path = path_along(grid, field, *entrance, request, request.goal_m);
      path.status = PathStatus::complete;
      return path;
    }
    why = kCutOff;
  }
  return second_best(grid, config, request, ways_in, std::move(why));
}

}  // namespace

Path plan(const DrivableGrid& grid, const PlanRequest& request, const PlannerConfig& config) {
  Field field;
  return plan_with(grid, request, config, [&](CellIndex goal) -> const Field& {
    return field = compute_field(grid, goal).value();
  });
}

Path plan(const DrivableGrid& grid, const Field& field, const PlanRequest& request,
          const PlannerConfig& config) {
  return plan_with(grid, request, config, [&](CellIndex goal) -> const Field& {
    assert(goal == field.goal);
    (void)goal;
    return field;
  });
}

std::string why_shut_in(const DrivableGrid& grid, const Eigen::Vector2d& place_m) {
  const auto cell = cell_at(grid, place_m);
  if (!cell) return "the start lies outside the map";
  return entrances(grid, place_m, *cell).empty() ? shut_in_at(grid, *cell) : std::string();
}

}  // namespace cairn
