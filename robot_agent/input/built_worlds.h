#pragma once

#include <cstdint>

#include "robot_agent/input/world.h"

namespace cairn::agent {

// The worlds that `make_world` builds, described there.
[[nodiscard]] World build_room(std::uint64_t seed);
[[nodiscard]] World build_ramp(std::uint64_t seed);
[[nodiscard]] World build_block(std::uint64_t seed);
[[nodiscard]] World build_hill(std::uint64_t seed);

/// The same place in a file's terrain: starts at the flattest open spot near the middle.
[[nodiscard]] World terrain_world(std::string name, HeightRaster surface);

/// The pose nearest to the given one from which a vehicle can set off: level to within 10 cm over
/// the size of a robot; the smoothest such spot of the surroundings.
[[nodiscard]] Pose open_spot(const HeightRaster& surface, double x_m, double y_m, double within_m);
/// Shifts the surface so that the start is at z = 0.
[[nodiscard]] World founded_at(std::string name, HeightRaster surface, const Pose& start);

}  // namespace cairn::agent
