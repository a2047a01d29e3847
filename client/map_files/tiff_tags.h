#pragma once

#include <string>

#include "client/map_files/raster.h"

namespace cairn::map_files {

/// What a (Geo)TIFF's first directory tells besides its pixels.
struct TiffTags {
  RasterFrame frame;                 ///< Size; cell size and place where GeoTIFF tags tell them.
  double no_data_m = kUsualNoDataM;  ///< Tag 42113, as GDAL writes it.
};

/// Reads the directory of a classic TIFF (TIFF 6.0; GeoTIFF 1.1: ModelPixelScale, ModelTiepoint).
/// corrupt when it is none or cut short; invalid_argument for geographic coordinates (degrees) and
/// for cells that are not square.
[[nodiscard]] Result<TiffTags> read_tiff_tags(const std::string& path);

}  // namespace cairn::map_files
