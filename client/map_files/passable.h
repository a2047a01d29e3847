#pragma once

#include "client/map_files/raster.h"

namespace cairn::map_files {

/// [mm] How high an obstacle of a 2-D map stands above the free ground beside it: more than any
/// vehicle may be told to climb.
inline constexpr std::int32_t kObstacleMm = 2500;
/// [mm] Further in it rises by this from cell to cell. So every cell of it stands above another one
/// and is an obstacle by itself, and 64 cells still fit the heights of a tile.
inline constexpr std::int32_t kRiseMm = 450;

struct Relief {
  HeightRaster raster;
  std::int64_t lone_obstacles = 0;  ///< Left unknown: no chain of them begins beside free ground.
};

/// A 2-D map as ground with heights: free cells at 0, unknown ones unknown, obstacles as above.
/// invalid_argument when no cell is free: there would be nothing to stand on.
[[nodiscard]] Result<Relief> relief_of(const ClassRaster& classes);

}  // namespace cairn::map_files
