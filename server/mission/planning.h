#pragma once

#include <memory>
#include <vector>

#include "core/common/result.h"
#include "core/planner/plan.h"
#include "server/world/snapshot.h"

namespace cairn::server {

/// The drivable grid of a snapshot: all known cells, and the two points with some room around them.
/// exhausted when that is more than a planner's window may hold.
[[nodiscard]] Result<DrivableGrid> drivable_grid(const MapSnapshot& map,
                                                 const std::vector<Eigen::Vector2d>& points_m,
                                                 const PlannerConfig& config,
                                                 std::uint8_t min_probability);

/// What of a path still lies ahead of a place: from its nearest point on.
[[nodiscard]] std::vector<Eigen::Vector2d> rest_of(const std::vector<Eigen::Vector2d>& path_m,
                                                   const Eigen::Vector2d& place_m);

/// Every leg of the path crosses only open cells.
[[nodiscard]] bool path_is_open(const DrivableGrid& grid,
                                const std::vector<Eigen::Vector2d>& path_m);

}  // namespace cairn::server
