#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/map/traversability.h"

namespace cairn::bench {

/// The kinds of ground that planners are measured on.
inline const std::vector<std::string> kWorlds = {"open", "random", "city", "maze", "terrain"};

/// A square world of one kind, closed all around; obstacles are blocks of 2 m. `random`: a fifth of
/// the cells; `city`: blocks of houses with yards, turned against the grid; `maze`: ways of eight
/// cells between walls of two, with some loops; `terrain`: hills, rocks and walls.
[[nodiscard]] HeightGrid planning_world(const std::string& kind, int size, std::uint32_t seed);

}  // namespace cairn::bench
