#pragma once

#include <string>

#include "client/map_files/raster.h"

namespace cairn::map_files {

/// Reads an Esri ASCII grid: ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize
/// and perhaps nodata_value, then the heights in metres from the north-west, in lines or not.
/// corrupt names the line: a missing or odd key, a word that is no number, too few or too many
/// heights, one out of range.
[[nodiscard]] Result<HeightRaster> read_esri_ascii(const std::string& path);
/// Requires: a cell size and a place, not turned.
[[nodiscard]] Status write_esri_ascii(const std::string& path, const HeightRaster& raster);

/// Reads rows of heights in metres, separated by blanks, commas or semicolons, the northernmost row
/// first; nan, -9999 and nothing between two commas are unknown. Neither cell size nor place.
/// corrupt names the line: rows of different length, a word that is no number, out of range.
[[nodiscard]] Result<HeightRaster> read_csv_heights(const std::string& path);
[[nodiscard]] Status write_csv_heights(const std::string& path, const HeightRaster& raster);

}  // namespace cairn::map_files
