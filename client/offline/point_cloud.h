#pragma once

#include <string>

#include "client/map_files/raster.h"
#include "server/world/snapshot.h"

namespace cairn::offline {

/// Writes every known cell of every level as a point (binary little-endian PLY: x, y, z as double
/// metres, probability as uchar), tile by tile.
[[nodiscard]] Status write_point_cloud(const std::string& path, const server::MapSnapshot& map,
                                       const map_files::RasterFrame::Corner& offset);

}  // namespace cairn::offline
