#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/planner/trulla.h"

namespace cairn {

/// A stretch of the border between open and unknown ground (T2.2.3, T4.3.5).
struct Frontier {
  CellIndex place;            ///< Its cell nearest to the middle of its cells: where to go.
  std::uint32_t cells = 0;
  double cost_m = 0.0;        ///< [m of level driving] To get there.
  double new_area_m2 = 0.0;   ///< Unknown ground within sight of `place`.
  double worth = 0.0;         ///< [m² per m] The higher the sooner.
};

struct FrontierConfig {
  int min_cells = 3;        ///< Smaller ones are gaps between beams. [Limit: ≥ 1]
  double sight_m = 4.0;     ///< How far new ground is counted. [Limit: 0.1 … 100]
  double nearness_m = 2.0;  ///< Added to the cost, so that none is worth endlessly much. [Limit: > 0]
};

/// One bit per cell, 64 to a word, rows rounded up to whole words: open cells with an unknown cell
/// among their eight neighbours.
[[nodiscard]] std::vector<std::uint64_t> frontier_flags(const DrivableGrid& grid);

/// Frontiers that can be reached, most worth first (of equals the southernmost, westernmost first).
/// `from_robot` is a field whose goal is where the robot is: its costs are those of the way back,
/// which stand for those of the way there. Linear in the cells.
[[nodiscard]] std::vector<Frontier> find_frontiers(const DrivableGrid& grid,
                                                   const Field& from_robot,
                                                   const FrontierConfig& config = {});

}  // namespace cairn
