#include "robot_agent/drive/detour.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/planner/plan.h"

namespace cairn::agent {

namespace {

/// [m] Places on the path that one may come back to lie this far from each other.
constexpr double kRejoinEveryM = 0.5;

/// A place on the path, and how far it is from there to the end.
struct Rejoin {
  Eigen::Vector2d place_m;
  double to_go_m = 0.0;
  std::size_t next = 0;  ///< The path's point that follows.
};

/// Beyond what closes the path, the end included.
std::vector<Rejoin> rejoins(const std::vector<Eigen::Vector2d>& ahead_m, double from_m) {
  std::vector<Rejoin> places;
  double way_m = 0.0;
  double next_m = from_m + kRejoinEveryM;
  for (std::size_t i = 1; i < ahead_m.size(); ++i) {
    const Eigen::Vector2d leg = ahead_m[i] - ahead_m[i - 1];
    const double leg_m = leg.norm();
    for (; next_m < way_m + leg_m; next_m += kRejoinEveryM) {
      places.push_back({ahead_m[i - 1] + leg * ((next_m - way_m) / leg_m), next_m, i});
    }
    way_m += leg_m;
  }
  places.push_back({ahead_m.back(), way_m, ahead_m.size()});
  for (Rejoin& place : places) place.to_go_m = way_m - place.to_go_m;
  return places;
}

CellIndex cell_at(const OwnMap& map, const Eigen::Vector2d& p_m) {
  const double cell_m = map.cell_size_mm / 1000.0;
  return {static_cast<std::int32_t>(std::floor(p_m.x() / cell_m)),
          static_cast<std::int32_t>(std::floor(p_m.y() / cell_m))};
}

PlannerConfig planning_within(const VehicleLimits& limits) {
  PlannerConfig config;
  config.limits = limits;
  return config;
}

std::optional<DrivableGrid> ground_between(const OwnMap& map, const VehicleLimits& limits,
                                           const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m,
                                           double reach_m) {
  const Eigen::Vector2d margin_m(reach_m, reach_m);
  auto grid = empty_grid(cell_at(map, a_m.cwiseMin(b_m) - margin_m),
                         cell_at(map, a_m.cwiseMax(b_m) + margin_m), map.cell_size_mm);
  if (!grid) return std::nullopt;
  copy_known(map.cells, map.min_probability, *grid);
  return make_drivable(std::move(*grid), planning_within(limits));
}

/// The one with the shortest way from the robot over it to the end, by what it costs to drive from
/// the robot (climbing and descending taken as equal: this only chooses among them).
std::optional<Rejoin> best_rejoin(const DrivableGrid& grid, const OwnMap& map,
                                  const Field& from_robot, const std::vector<Rejoin>& places) {
  double least_m = std::numeric_limits<double>::infinity();
  std::optional<Rejoin> best;
  for (const Rejoin& place : places) {
    const std::uint32_t cost = cost_to_goal(grid, from_robot, cell_at(map, place.place_m));
    const double way_m = cost * grid.unit_m() + place.to_go_m;
    if (cost == kNoWay || way_m >= least_m) continue;
    least_m = way_m;
    best = place;
  }
  return best;
}

std::optional<std::vector<Eigen::Vector2d>> planned(const DrivableGrid& grid,
                                                    const VehicleLimits& limits,
                                                    const Eigen::Vector2d& from_m,
                                                    const Eigen::Vector2d& to_m) {
  Path path = plan(grid, {.start_m = from_m, .goal_m = to_m}, planning_within(limits));
  if (path.status != PathStatus::complete) return std::nullopt;
  return std::move(path.points_m);
}

}  // namespace

std::optional<std::vector<Eigen::Vector2d>> way_around(const OwnMap& map,
                                                       const VehicleLimits& limits,
                                                       const Eigen::Vector2d& place_m,
                                                       const std::vector<Eigen::Vector2d>& ahead_m,
                                                       double clear_m, DetourReach reach) {
  const Eigen::Vector2d& end_m = ahead_m.back();
  if (reach == DetourReach::far) {
    if ((end_m - place_m).cwiseAbs().maxCoeff() > kMostFarM) return std::nullopt;
    const auto grid = ground_between(map, limits, place_m, end_m, kFarReachM);
    return grid ? planned(*grid, limits, place_m, end_m) : std::nullopt;
  }
  const auto grid = ground_between(map, limits, place_m, place_m, kNearReachM);
  if (!grid) return std::nullopt;
  const auto from_robot = compute_field(*grid, cell_at(map, place_m));
  if (!from_robot) return std::nullopt;
  const auto back = best_rejoin(*grid, map, *from_robot, rejoins(ahead_m, clear_m));
  if (!back) return std::nullopt;
  auto way_m = planned(*grid, limits, place_m, back->place_m);
  if (way_m)
    way_m->insert(way_m->end(), ahead_m.begin() + static_cast<std::ptrdiff_t>(back->next),
                  ahead_m.end());
  return way_m;
}

}  // namespace cairn::agent
