#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>

#include "core/map/packed_tile.h"
#include "core/map/tile.h"

namespace cairn::server {

/// The whole long-term map of a site at one moment. Immutable: readers keep it as long as they
/// like and never hold up the writer; unchanged tiles are shared between snapshots.
struct MapSnapshot {
  using Tiles = std::unordered_map<TileKey, std::shared_ptr<const PackedTile>, TileKeyHash>;

  std::uint64_t version = 0;  ///< Log sequence of the newest evidence in it.
  int cell_size_mm = 125;
  Tiles tiles;
  std::uint64_t known_cells = 0;
  std::uint64_t memory_bytes = 0;  ///< Of the tiles and their table.
};

}  // namespace cairn::server
