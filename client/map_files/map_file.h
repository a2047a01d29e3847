#pragma once

#include <string>

#include "client/map_files/passable.h"
#include "client/map_files/raster.h"

namespace cairn::map_files {

/// Kinds of map files, told apart by the ending of their name.
enum class MapFileKind : std::uint8_t {
  movingai,  ///< .map
  ros,       ///< .yaml, .yml; .pgm stands for the .yaml beside it
  esri,      ///< .asc
  csv,       ///< .csv, .txt
  tiff,      ///< .tif, .tiff
  ply,       ///< .ply; written only
};

/// invalid_argument, naming all endings, for another one.
[[nodiscard]] Result<MapFileKind> kind_of(const std::string& path);
/// 2-D maps tell where a robot can be, the others tell heights.
[[nodiscard]] constexpr bool is_2d(MapFileKind kind) {
  return kind == MapFileKind::movingai || kind == MapFileKind::ros;
}

/// Reads any of them as ground with heights. Errors as the readers of each.
[[nodiscard]] Result<Relief> read_map_file(const std::string& path);

}  // namespace cairn::map_files
