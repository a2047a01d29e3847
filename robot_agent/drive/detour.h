#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/map/traversability.h"
#include "robot_agent/drive/local_view.h"

namespace cairn::agent {

/// The robot's own map, as the driver is given it at each step.
struct OwnMap {
  const CellLookup& cells;
  int cell_size_mm = 0;
  std::uint8_t min_probability = 0;
};

/// How far around itself a robot plans.
enum class DetourReach : std::uint8_t {
  near,  ///< Around what closes the way and back to the path as soon as that pays (T2.2.4).
  far,   ///< To the goal itself, on all that the robot knows between: the server is away.
};

/// [m] How far to each side of the robot it looks, and how far around robot and goal.
inline constexpr double kNearReachM = 8.0;
inline constexpr double kFarReachM = 30.0;
/// [m] `far` is refused when robot and goal are further apart than this along x or y.
inline constexpr double kMostFarM = 200.0;

/// A way around what closes the path `clear_m` ahead, planned on ground the robot has seen: from
/// `place_m` back to the path and along it to its end, or straight to its end where that is
/// cheaper. `ahead_m` is the rest of the path, from the robot's foot on it. `limits` hold for the
/// planning. Empty when there is none.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> way_around(
    const OwnMap& map, const VehicleLimits& limits, const Eigen::Vector2d& place_m,
    const std::vector<Eigen::Vector2d>& ahead_m, double clear_m, DetourReach reach);

}  // namespace cairn::agent
