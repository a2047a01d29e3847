#include "server/mission/exploring.h"

#include <algorithm>

namespace cairn::server {

namespace {

/// [m] A frontier has been seen when none is this near any more: it recedes as the robot nears.
constexpr double kStillThereM = 0.8;

bool near_any(const std::vector<Eigen::Vector2d>& places_m, const Eigen::Vector2d& place_m,
              double within_m) {
  return std::ranges::any_of(places_m, [&](const Eigen::Vector2d& other_m) {
    return (other_m - place_m).norm() <= within_m;
  });
}

}  // namespace

FrontierChoice choose_frontier(const DrivableGrid& grid, const ExploreWish& wish,
                               const PlannerConfig& planner) {
  FrontierChoice choice;
  int tries = 0;
  for (const Frontier& frontier : find_frontiers(grid, wish.from_m, {}, wish.area)) {
    if (near_any(wish.avoided_m, frontier.place_m, kSamePlaceM)) continue;
    if (near_any(wish.claimed_m, frontier.place_m, kClaimM)) {
      ++choice.claimed;
      continue;
    }
    if (++tries > kMaxTries) break;
    PlanRequest request;
    request.start_m = wish.from_m;
    request.goal_m = frontier.place_m;
    choice.path = plan(grid, request, planner);
    if (choice.path.status == PathStatus::complete) {
      choice.frontier = frontier;
      return choice;
    }
    choice.unreachable_m.push_back(frontier.place_m);
  }
  choice.shut_in = why_shut_in(grid, wish.from_m);
  return choice;
}

bool still_a_frontier(const DrivableGrid& grid, const ExploreWish& wish,
                      const Eigen::Vector2d& place_m) {
  const auto found = find_frontiers(grid, wish.from_m, {}, wish.area);
  const double cell_m = grid.heights.cell_size_mm / 1000.0;
  return std::ranges::any_of(found, [&](const Frontier& frontier) {
    return std::ranges::any_of(frontier.edge, [&](CellIndex cell) {
      const Eigen::Vector2d middle_m((cell.x + 0.5) * cell_m, (cell.y + 0.5) * cell_m);
      return (middle_m - place_m).norm() <= kStillThereM;
    });
  });
}

void end_exploring(Task& task, const FrontierChoice& choice) {
  task.state = choice.shut_in.empty() ? TaskState::done : TaskState::failed;
  task.why = choice.shut_in.empty() ? "nothing that can be reached is left to explore"
                                    : "it cannot leave where it stands: " + choice.shut_in;
  if (task.avoided_m.empty()) return;
  task.why +=
      "; " + std::to_string(task.avoided_m.size()) + " places showed nothing new or had no way";
}

}  // namespace cairn::server
