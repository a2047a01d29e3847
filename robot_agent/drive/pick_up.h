#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/map/traversability.h"
#include "robot_agent/drive/corridor_map.h"
#include "robot_agent/drive/detour.h"

namespace cairn::agent {

/// A way that leaves the path and picks the field up elsewhere.
struct PickedUp {
  std::vector<Eigen::Vector2d> way_m;
  bool to_goal = false;  ///< It leads to the order's end, as far as the order does.
};

/// Around what closes the way: over ground that the robot has seen to a cell of the corridor from
/// which the field's directions lead on past what closes it, and down them (T2.2.4). Of all such
/// cells within kNearReachM the one by which the whole way is shortest. Follows directions over
/// ground that the robot has not seen, but nowhere that it knows to be closed. `limits` hold for
/// the planning. nullopt when there is none.
[[nodiscard]] std::optional<PickedUp> pick_up_field(const OwnMap& map, const VehicleLimits& limits,
                                                    const Eigen::Vector2d& place_m,
                                                    const CorridorMap& corridor);

}  // namespace cairn::agent
