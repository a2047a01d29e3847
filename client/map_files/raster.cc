#include "client/map_files/raster.h"

#include <cmath>
#include <string>

#include "core/map/height_map.h"

namespace cairn::map_files {

Status set_size(RasterFrame& frame, std::int64_t columns, std::int64_t rows) {
  const std::string size = std::to_string(columns) + " x " + std::to_string(rows) + " cells";
  if (columns < 1 || rows < 1) {
    return Error{ErrorCode::invalid_argument, size + ": there must be at least one"};
  }
  if (columns > RasterFrame::kMaxCells / rows) {
    return Error{ErrorCode::exhausted, size + " are more than the " +
                                           std::to_string(RasterFrame::kMaxCells) +
                                           " that are read at once: cut the file into parts"};
  }
  frame.columns = static_cast<int>(columns);
  frame.rows = static_cast<int>(rows);
  return {};
}

Result<std::int32_t> height_mm_of(double height_m, double no_data_m) {
  // Programs that know no better mark what is missing by the lowest float there is.
  const bool missing = std::isnan(height_m) || height_m == no_data_m ||
                       height_m <= double{std::numeric_limits<float>::lowest()};
  if (missing) return HeightRaster::kUnknown;
  if (!(std::abs(height_m) <= HeightMap::kMaxExtentM)) {
    return Error{ErrorCode::invalid_argument,
                 "a height of " + std::to_string(height_m) + " m is out of range (100 km)"};
  }
  return static_cast<std::int32_t>(std::lround(height_m * 1000.0));
}

}  // namespace cairn::map_files
