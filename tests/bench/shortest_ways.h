#pragma once

#include <optional>

#include "core/planner/trulla.h"

namespace cairn::bench {

/// [cells] Length of the shortest way between two cells' middles on flat ground that may graze
/// corners: A* over the corners of closed cells that see each other (Lozano-Pérez & Wesley 1979).
/// A path that keeps off the corners can come near it, not below. Nothing when there is no way.
[[nodiscard]] std::optional<double> shortest_way(const DrivableGrid& grid, CellIndex start,
                                                 CellIndex goal);

}  // namespace cairn::bench
