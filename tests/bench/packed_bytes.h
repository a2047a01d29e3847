#pragma once

#include <unordered_map>

#include "core/map/height_map.h"
#include "core/map/packed_tile.h"

namespace cairn::bench {

/// The bytes that a map takes at rest: its tiles packed, in a table by their keys. Counted are the
/// packed bytes, the table's node (key, tile, link, hash), its bucket, and what the allocator adds
/// to node and bytes.
[[nodiscard]] inline double packed_bytes(const HeightMap& map) {
  constexpr std::size_t kAllocator = 16;
  constexpr std::size_t kNode =
      sizeof(std::pair<const TileKey, PackedTile>) + 2 * sizeof(void*) + kAllocator;
  constexpr std::size_t kBucket = sizeof(void*);
  std::size_t bytes = 0;
  for (const auto& [key, tile] : map.tiles()) {
    bytes += PackedTile::pack(*tile).bytes().size() + kAllocator + kNode + kBucket;
  }
  return static_cast<double>(bytes);
}

}  // namespace cairn::bench
