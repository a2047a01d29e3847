#pragma once

#include <string>

#include "client/map_files/raster.h"

namespace cairn::map_files {

/// Reads a (Geo)TIFF of heights in metres: one channel, of any number type that OpenCV reads. NaN
/// and the file's no-data value (-9999 unless it names one) are unknown. Errors as read_tiff_tags;
/// corrupt for several channels, pixels that cannot be decoded or a height out of range.
[[nodiscard]] Result<HeightRaster> read_height_tiff(const std::string& path);

/// Writes 32-bit floats, not packed, with GeoTIFF tags for cell size and place, and no-data -9999.
/// Requires: a cell size and a place, not turned.
[[nodiscard]] Status write_height_tiff(const std::string& path, const HeightRaster& raster);

}  // namespace cairn::map_files
