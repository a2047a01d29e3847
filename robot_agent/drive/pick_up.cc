#include "robot_agent/drive/pick_up.h"

#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "core/planner/plan.h"
#include "robot_agent/drive/local_view.h"

namespace cairn::agent {

namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
/// [m] How far the way may lie from the cells that the directions lead over.
constexpr double kToleranceM = 0.1;

double length_of(const std::vector<Eigen::Vector2d>& points_m) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < points_m.size(); ++i) {
    length_m += (points_m[i] - points_m[i - 1]).norm();
  }
  return length_m;
}

CellIndex step_from(CellIndex cell, std::uint8_t direction) {
  return {cell.x + kStepX[direction], cell.y + kStepY[direction]};
}

/// The window around the robot, once with unseen ground closed and once with it open.
struct Window {
  DrivableGrid seen;
  DrivableGrid unseen_too;
};

std::optional<Window> window_around(const OwnMap& map, const VehicleLimits& limits,
                                    const Eigen::Vector2d& place_m) {
  const double cell_m = map.cell_size_mm / 1000.0;
  const auto cell_at = [&](const Eigen::Vector2d& p_m) {
    return CellIndex{static_cast<std::int32_t>(std::floor(p_m.x() / cell_m)),
                     static_cast<std::int32_t>(std::floor(p_m.y() / cell_m))};
  };
  const Eigen::Vector2d reach_m(kNearReachM, kNearReachM);
  auto heights =
      empty_grid(cell_at(place_m - reach_m), cell_at(place_m + reach_m), map.cell_size_mm);
  if (!heights) return std::nullopt;
  copy_known(map.cells, map.min_probability, *heights);
  PlannerConfig config;
  config.limits = limits;
  DrivableGrid seen = make_drivable(*heights, config);
  config.unknown = UnknownGround::allowed;
  return Window{std::move(seen), make_drivable(std::move(*heights), config)};
}

/// How far it is down the directions, cell by cell; each cell is looked at once.
class WaysDown {
 public:
  WaysDown(const CorridorMap& corridor, const DrivableGrid& window)
      : corridor_(corridor), window_(window), cell_m_(window.heights.cell_size_mm / 1000.0) {}

  /// [m] To the order's end; kNowhere when the directions do not lead there.
  double to_go_m(CellIndex cell) {
    std::vector<CellIndex> walked;
    double left_m = kNowhere;
    while (true) {
      // Met again before it is known it is on a ring, which directions of different maps may make.
      const auto [known, is_new] = to_go_.try_emplace(key(cell), kNowhere);
      if (!is_new) {
        left_m = known->second;
        break;
      }
      const auto next = next_of(cell);
      if (!next) {
        left_m = known->second = at_end_m(cell);
        break;
      }
      walked.push_back(cell);
      cell = *next;
    }
    for (; !walked.empty(); walked.pop_back()) {
      const std::uint8_t direction = corridor_.direction(walked.back());
      left_m += std::hypot(kStepX[direction], kStepY[direction]) * cell_m_;
      to_go_[key(walked.back())] = left_m;
    }
    return left_m;
  }

  /// Over the cells' middles and what follows. Requires: to_go_m(cell) is finite.
  [[nodiscard]] PickedUp way_from(CellIndex cell) const {
    PickedUp way{{middle_m(cell)}, true};
    while (const auto next = next_of(cell)) {
      cell = *next;
      way.way_m.push_back(middle_m(cell));
    }
    if (corridor_.direction(cell) == Corridor::at_goal) {
      way.way_m.push_back(corridor_.goal_m());
      return way;
    }
    const auto rest = corridor_.rest_from(cell);
    way.way_m.insert(way.way_m.end(), rest->points_m.begin(), rest->points_m.end());
    way.to_goal = rest->to_goal;
    return way;
  }

 private:
  static std::uint64_t key(CellIndex cell) {
    return std::uint64_t{static_cast<std::uint32_t>(cell.x)} << 32U |
           static_cast<std::uint32_t>(cell.y);
  }
  [[nodiscard]] Eigen::Vector2d middle_m(CellIndex cell) const {
    return {(cell.x + 0.5) * cell_m_, (cell.y + 0.5) * cell_m_};
  }
  /// None at the goal, at the corridor's end, and before what is closed.
  [[nodiscard]] std::optional<CellIndex> next_of(CellIndex cell) const {
    const std::uint8_t direction = corridor_.direction(cell);
    if (direction >= Corridor::at_goal || closed(cell, direction)) return std::nullopt;
    const CellIndex next = step_from(cell, direction);
    if (corridor_.direction(next) == Corridor::outside) return std::nullopt;
    return next;
  }
  [[nodiscard]] bool closed(CellIndex cell, std::uint8_t direction) const {
    return window_.heights.contains(cell) && window_.heights.contains(step_from(cell, direction)) &&
           step_cost(window_, cell, direction) == kNoWay;
  }
  /// [m] What is left where the directions end.
  [[nodiscard]] double at_end_m(CellIndex cell) const {
    const std::uint8_t direction = corridor_.direction(cell);
    if (direction == Corridor::at_goal) return (corridor_.goal_m() - middle_m(cell)).norm();
    if (direction > Corridor::at_goal || closed(cell, direction)) return kNowhere;
    const auto rest = corridor_.rest_from(cell);
    if (!rest) return kNowhere;
    return (rest->points_m.front() - middle_m(cell)).norm() + length_of(rest->points_m);
  }

  const CorridorMap& corridor_;
  const DrivableGrid& window_;
  double cell_m_;
  std::unordered_map<std::uint64_t, double> to_go_;  ///< Bounded by the corridors' cells.
};

/// The cell of the corridor by which the way to the end is shortest.
std::optional<CellIndex> best_landing(const DrivableGrid& seen, const Field& from_robot,
                                      const CorridorMap& corridor, WaysDown& ways) {
  std::optional<CellIndex> best;
  double least_m = kNowhere;
  for (int y = 0; y < seen.heights.height; ++y) {
    for (int x = 0; x < seen.heights.width; ++x) {
      const CellIndex cell{seen.heights.origin.x + x, seen.heights.origin.y + y};
      if (corridor.direction(cell) > Corridor::at_goal) continue;
      const std::uint32_t cost = cost_to_goal(seen, from_robot, cell);
      if (cost == kNoWay || cost * seen.unit_m() >= least_m) continue;
      const double way_m = cost * seen.unit_m() + ways.to_go_m(cell);
      if (way_m >= least_m) continue;
      least_m = way_m;
      best = cell;
    }
  }
  return best;
}

/// Takes the steps from cell to cell out of what of a way lies in the window.
std::vector<Eigen::Vector2d> smoothed(const DrivableGrid& window,
                                      const std::vector<Eigen::Vector2d>& way_m) {
  const double cell_m = window.heights.cell_size_mm / 1000.0;
  std::size_t inside = 0;
  while (inside < way_m.size() &&
         window.heights.contains(
             {static_cast<std::int32_t>(std::floor(way_m[inside].x() / cell_m)),
              static_cast<std::int32_t>(std::floor(way_m[inside].y() / cell_m))})) {
    ++inside;
  }
  const auto edge = way_m.begin() + static_cast<std::ptrdiff_t>(inside);
  const std::vector<Eigen::Vector2d> near_m(way_m.begin(), edge);
  std::vector<Eigen::Vector2d> smooth = simplify(window, near_m, kToleranceM);
  smooth.insert(smooth.end(), edge, way_m.end());
  return smooth;
}

}  // namespace

std::optional<PickedUp> pick_up_field(const OwnMap& map, const VehicleLimits& limits,
                                      const Eigen::Vector2d& place_m, const CorridorMap& corridor) {
  if (corridor.empty()) return std::nullopt;
  const auto window = window_around(map, limits, place_m);
  if (!window) return std::nullopt;
  const double cell_m = map.cell_size_mm / 1000.0;
  const auto from_robot =
      compute_field(window->seen, {static_cast<std::int32_t>(std::floor(place_m.x() / cell_m)),
                                   static_cast<std::int32_t>(std::floor(place_m.y() / cell_m))});
  if (!from_robot) return std::nullopt;
  WaysDown ways(corridor, window->unseen_too);
  const auto landing = best_landing(window->seen, *from_robot, corridor, ways);
  if (!landing) return std::nullopt;
  PickedUp picked = ways.way_from(*landing);
  PlannerConfig config;
  config.limits = limits;
  Path there = plan(window->seen, {.start_m = place_m, .goal_m = picked.way_m.front()}, config);
  if (there.status != PathStatus::complete) return std::nullopt;
  picked.way_m = smoothed(window->unseen_too, picked.way_m);
  picked.way_m.insert(picked.way_m.begin(), there.points_m.begin(), there.points_m.end() - 1);
  return picked;
}

}  // namespace cairn::agent
