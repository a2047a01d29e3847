#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/pose/pose.h"
#include "robot_agent/input/height_raster.h"
#include "robot_agent/input/passers_by.h"

namespace cairn::agent {

/// A place to drive in: the top surface of the ground and all that stands on it.
struct World {
  std::string name;
  HeightRaster surface;
  Pose start;  ///< In the site frame; the surface there is at z = 0.
  std::vector<PasserBy> passers_by{};
};

/// The names `make_world` knows, for help and messages: "room", "ramp", "block", "hill" and
/// "dem:FILE[@CELL_SIZE]".
[[nodiscard]] std::vector<std::string> world_names();

/// Makes a world; the same name and seed give the same world.
/// - room: a 13 × 13 m laboratory with furniture; a lap around it is free.
/// - ramp: along a building up a ramp (≤ 8°) to a platform 1 m high with a sheer edge.
/// - block: an urban block of 100 × 100 m: roads, kerbs, buildings, steps, trees, cars.
/// - hill: 100 × 100 m of natural ground with rocks and trees.
/// - dem:FILE[@CELL_SIZE]: a terrain file, see `read_dem`.
/// Errors: an unknown name; an unreadable or unusable terrain file.
[[nodiscard]] Result<World> make_world(const std::string& name, std::uint64_t seed);

}  // namespace cairn::agent
