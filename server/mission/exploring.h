#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/frontier/frontier.h"
#include "core/planner/plan.h"
#include "server/mission/task.h"

namespace cairn::server {

/// What a robot that explores must know to choose where to go next.
struct ExploreWish {
  Eigen::Vector2d from_m;
  std::optional<AreaM> area;
  std::vector<Eigen::Vector2d> avoided_m;  ///< See Task.
  std::vector<Eigen::Vector2d> claimed_m;  ///< Where other robots are on their way to.
};

struct FrontierChoice {
  std::optional<Frontier> frontier;            ///< None: there is nothing to choose.
  Path path;                                   ///< To it.
  std::vector<Eigen::Vector2d> unreachable_m;  ///< Tried in vain; to be avoided.
  std::size_t claimed = 0;                     ///< Frontiers left to other robots.
  std::string shut_in;  ///< Why the robot can go nowhere at all; empty: it can.
};

/// [m] Frontiers this near an avoided place are that place.
inline constexpr double kSamePlaceM = 0.6;
/// [m] Frontiers this near where another robot goes are that robot's.
inline constexpr double kClaimM = 4.0;
/// [frontiers] Planned to before a choice gives up for now.
inline constexpr int kMaxTries = 8;

/// The most promising frontier that is neither avoided nor claimed and that a path leads to.
/// Requires: a grid made with `planner`, whose unknown ground is blocked.
[[nodiscard]] FrontierChoice choose_frontier(const DrivableGrid& grid, const ExploreWish& wish,
                                             const PlannerConfig& planner);

/// Whether there is still something new to see at a place that was chosen.
[[nodiscard]] bool still_a_frontier(const DrivableGrid& grid, const ExploreWish& wish,
                                    const Eigen::Vector2d& place_m);

/// Ends a task for which there was twice nothing to choose: done, unless the robot is shut in.
void end_exploring(Task& task, const FrontierChoice& choice);

}  // namespace cairn::server
