#pragma once

#include <memory>
#include <vector>

#include "core/common/result.h"
#include "core/planner/plan.h"
#include "server/world/snapshot.h"

namespace cairn::server {

/// Cells from the lowest to the highest, both included.
struct MapWindow {
  CellIndex lowest;
  CellIndex highest;
  friend bool operator==(const MapWindow&, const MapWindow&) = default;
};

/// All tiles of a snapshot, and those around the points with some room. Whole tiles, so that it
/// stays the same while a robot drives along the map's edge.
/// unavailable when there is neither a tile nor a point.
[[nodiscard]] Result<MapWindow> window_around(const MapSnapshot& map,
                                              const std::vector<Eigen::Vector2d>& points_m);

/// The heights of a snapshot's cells in the window. exhausted when that is more than a planner's
/// window may hold.
[[nodiscard]] Result<HeightGrid> heights_in(const MapSnapshot& map, const MapWindow& window,
                                            std::uint8_t min_probability);

/// The drivable grid of a snapshot: window_around the points. Errors as above.
[[nodiscard]] Result<DrivableGrid> drivable_grid(const MapSnapshot& map,
                                                 const std::vector<Eigen::Vector2d>& points_m,
                                                 const PlannerConfig& config,
                                                 std::uint8_t min_probability);

/// What of a path still lies ahead of a place: from its nearest point on.
[[nodiscard]] std::vector<Eigen::Vector2d> rest_of(const std::vector<Eigen::Vector2d>& path_m,
                                                   const Eigen::Vector2d& place_m);

/// Every leg of the path crosses only open cells, from where it leaves the closed ones that it may
/// begin in: plan() leads out of them.
[[nodiscard]] bool path_is_open(const DrivableGrid& grid,
                                const std::vector<Eigen::Vector2d>& path_m);

}  // namespace cairn::server
