#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/frontier/reach.h"
#include "tests/bench/true_ground.h"

namespace cairn::bench {

/// Row by row as the ground's cells: 1 where a vehicle at `from_m` can get to.
[[nodiscard]] std::vector<std::uint8_t> reachable_cells(const DrivableGrid& ground,
                                                        const Eigen::Vector2d& from_m);

/// The share of the reachable cells that a map knows.
[[nodiscard]] double share_known(const DrivableGrid& ground,
                                 const std::vector<std::uint8_t>& reachable,
                                 const std::function<bool(CellIndex)>& known);

struct OracleDrive {
  double driven_m = 0.0;
  double share = 0.0;  ///< Of the reachable cells that it saw.
  std::vector<Eigen::Vector2d> places_m;
};

/// How far a greedy robot drives that knows the ground and where it is: on the shortest way to the
/// place with the most that can be reached and is yet unseen within 2.5 m, for the way there, as
/// frontiers are ranked; with the real robot's lasers, free of noise, until it has seen `share` of
/// all that can be reached.
[[nodiscard]] OracleDrive drive_greedily(const agent::World& world, const DrivableGrid& ground,
                                         double share);

}  // namespace cairn::bench
