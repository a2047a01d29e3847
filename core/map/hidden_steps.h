#pragma once

#include <vector>

#include "core/map/traversability.h"

namespace cairn {

/// [cells] A laser that looks down over a kerb misses no more of the ground behind its edge than
/// this; a longer unseen stretch tells nothing of what it hides.
inline constexpr int kHiddenStepCells = 5;
/// [cells] A change of a height changes no hidden step farther away than this.
inline constexpr int kHiddenStepReach = kHiddenStepCells + 1;

/// Makes obstacles of unknown cells that hide a step down from ground one can stand on: along a row
/// or a column no more than kHiddenStepCells of them lie between two known cells, of which one is
/// higher by more than the vehicle can climb or descend, and level with the known one behind it.
/// Requires: `classes` are those of the grid.
void mark_hidden_steps(const HeightGrid& grid, const VehicleLimits& limits,
                       std::vector<CellClass>& classes);

}  // namespace cairn
