#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/map/tile.h"

namespace cairn::bench {

/// Another way to write a whole tile.
struct TileBaseline {
  std::string name;
  std::function<std::size_t(const Tile&)> size_bytes;
};

/// zstd -19 over several layouts of a tile in planes; empty when zstd was absent at build time.
[[nodiscard]] std::vector<TileBaseline> tile_baselines();

}  // namespace cairn::bench
