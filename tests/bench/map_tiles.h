#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/common/result.h"
#include "core/map/tile.h"
#include "tests/bench/drive_about.h"

namespace cairn::bench {

using MapTiles = std::vector<std::pair<TileKey, Tile>>;  ///< Sorted by key.

/// The long-term map that a drive leaves: submaps of 8 m of way, written as coarsely as they are
/// told, folded one after the other. `moved`: each lies where a pose graph might put it, some
/// millimetres and milliradians off the grid.
[[nodiscard]] Result<MapTiles> tiles_of_drive(const DriveSetting& setting, bool moved);

/// The tiles of a terrain file as it is imported: every height known, rounded to millimetres.
[[nodiscard]] Result<MapTiles> tiles_of_terrain(const std::string& file);

}  // namespace cairn::bench
