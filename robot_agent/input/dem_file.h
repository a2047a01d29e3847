#pragma once

#include <string>

#include "core/common/result.h"
#include "robot_agent/input/height_raster.h"

namespace cairn::agent {

/// Reads a terrain file named "FILE" or "FILE@CELL_SIZE" (metres): a TIFF with one channel of
/// 32-bit floats, or a .csv of rows of heights in metres separated by spaces, commas or semicolons.
/// The first row is the northernmost; the site's origin is in the middle. Without @CELL_SIZE a part
/// of the file name like 10cm, 0.5m or 1m tells it. Missing heights (not finite, or ≤ -9000) are
/// filled with the mean of their neighbours, from the edges of a hole inward. Errors: no such file,
/// no heights in it, ragged rows, a word that is not a number, more than HeightRaster::kMaxNodes
/// heights, an unknown cell size.
[[nodiscard]] Result<HeightRaster> read_dem(const std::string& name);

}  // namespace cairn::agent
