#pragma once

#include <string>

#include "client/map_files/raster.h"

namespace cairn::map_files {

/// Reads a map of the Moving AI Lab's benchmarks (movingai.com/benchmarks/formats.html). Passable
/// are '.', 'G' and 'S' (swamp, passable from terrain); '@', 'O', 'T' and 'W' (water cannot be
/// entered from terrain) are obstacles. The format tells neither cell size nor place.
/// corrupt names the line: another type, a missing or odd size, short or long rows, too few or too
/// many of them, another letter.
[[nodiscard]] Result<ClassRaster> read_movingai_map(const std::string& path);

/// '.' where free, '@' elsewhere.
[[nodiscard]] Status write_movingai_map(const std::string& path, const ClassRaster& raster);

}  // namespace cairn::map_files
