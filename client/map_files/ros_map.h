#pragma once

#include <string>

#include "client/map_files/raster.h"

namespace cairn::map_files {

/// Reads a map of ROS map_server: the YAML file, and the picture it names (PGM or
/// PNG). Understands modes trinary, scale (both by the two thresholds: what lies between them is
/// unknown) and raw. not_found for a missing picture; corrupt for a missing key, a value out of its
/// bounds, a picture that is cut short.
[[nodiscard]] Result<ClassRaster> read_ros_map(const std::string& yaml_path);

/// Writes NAME.yaml and NAME.pgm beside it, as map_saver does: 254 free, 0 occupied, 205 unknown.
/// `path` is either of them. Requires: a cell size and a place.
[[nodiscard]] Status write_ros_map(const std::string& path, const ClassRaster& raster);

}  // namespace cairn::map_files
