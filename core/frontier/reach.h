#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/planner/trulla.h"

namespace cairn {

/// How far it is to everywhere a vehicle can get to, in steps to eight neighbours.
struct Reach {
  /// Row by row as the grid, [1/5 of a cell]: a step to the side is 5, a diagonal one 7.
  std::vector<std::uint32_t> way;

  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr double kPerCell = 5.0;
};

/// From a place over all open cells that can be driven to: no corner of a closed cell is cut, no
/// step is beyond the limits in the direction of travel. A start in a closed cell may be left
/// through other closed ones, but no obstacles, within 2 · radius + 2 cells, as plan() does.
/// Empty reach when the place lies outside of the grid. Time and memory (4 bytes) go with the
/// cells.
[[nodiscard]] Reach reach_from(const DrivableGrid& grid, const Eigen::Vector2d& place_m);

}  // namespace cairn
