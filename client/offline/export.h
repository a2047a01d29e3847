#pragma once

#include <string>

#include "client/offline/site.h"
#include "core/map/traversability.h"

namespace cairn::offline {

struct ExportReport {
  std::string kind;  ///< "Moving AI map", …
  std::int64_t columns = 0;
  std::int64_t rows = 0;
  std::uint64_t known_cells = 0;
};

/// Writes a site's ground level in the kind that the file's ending names: all known cells and the
/// smallest rectangle around them (PLY: a point for each known cell of every level). `limits`
/// decide what is an obstacle in 2-D maps. Coordinates are those of the site plus its offset.
/// Memory: 10 bytes per cell of the rectangle, which is refused beyond HeightGrid::kMaxCells
/// (exhausted); a PLY needs none.
/// unavailable when nothing is known; invalid_argument for another ending; io.
[[nodiscard]] Result<ExportReport> export_map(const OpenSite& site, const std::string& file,
                                              const VehicleLimits& limits);

}  // namespace cairn::offline
