#pragma once

#include "core/map/cell.h"

namespace cairn {

/// No beam crosses more cells than this; longer walks end there.
inline constexpr int kMaxBeamCells = 8192;

/// Walks the cells that the segment (x0, y0)-(x1, y1) [m] crosses, in order from its start, and
/// calls visit(CellIndex, t) with t in [0, 1], the middle of the segment's stay in that cell
/// (Amanatides & Woo 1987).
/// Requires: finite coordinates within HeightMap::kMaxExtentM, cell_m > 0.
template <class Visit>
void walk_cells(double x0_m, double y0_m, double x1_m, double y1_m, double cell_m, Visit&& visit);

}  // namespace cairn
