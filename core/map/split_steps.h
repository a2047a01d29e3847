#pragma once

#include <vector>

#include "core/map/traversability.h"

namespace cairn {

/// [cells] A change of a height changes no class farther away than this.
inline constexpr int kSplitStepReach = 3;

/// Marks steps that the grid has cut in two. A kerb's edge rarely runs between cells: the cell that
/// it runs through holds a height between, and both halves of the step may be below the limit
/// though the whole is not. Where the ground falls by more than `limit_mm` over two cells, along
/// any of eight directions, and is level above and below that, the upper cell is an obstacle, and
/// the one between when more than a quarter of the step lies below it. Slopes go on above or below,
/// and stay what they are.
void mark_split_steps(const HeightGrid& grid, std::int32_t limit_mm,
                      std::vector<CellClass>& classes);

}  // namespace cairn
