#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "core/map/height_map.h"
#include "core/map/packed_tile.h"
#include "proto/codec/frame.h"
#include "proto/sync/transit.h"

namespace cairn::proto {

/// Of a tile's content: its datum and every known cell. 0: nothing is known in it.
[[nodiscard]] std::uint32_t digest_of(const PackedTile& tile);

/// A region of tiles, as MapDigest names it.
struct Region {
  std::int8_t level = 0;
  std::int32_t rx = 0;
  std::int32_t ry = 0;
  friend auto operator<=>(const Region&, const Region&) = default;
};
[[nodiscard]] Region region_of(const TileKey& key);
/// The tile's place in its region.
[[nodiscard]] std::uint8_t place_of(const TileKey& key);
/// The tile that a digest's entry speaks of.
[[nodiscard]] TileKey tile_of(const MapDigest& digest, const MapDigest::Tile& tile);

/// The robot's half of comparing maps (PROTOCOL.md §7): digests on their way, each sent until
/// acknowledged.
class DigestSender {
 public:
  static constexpr std::size_t kMaxWaiting = 1024;  ///< Beyond it the new ones are dropped.

  void tell(std::vector<MapDigest> digests);
  /// A new session: nothing waits.
  void on_session() { items_.clear(); }
  int fill(FrameWriter& frame, std::uint32_t number);
  void on_acked(std::uint32_t number);
  void on_lost(std::uint32_t number);
  [[nodiscard]] bool has_news() const;
  [[nodiscard]] bool idle() const { return items_.empty(); }

 private:
  struct Item {
    MapDigest digest;
    Transit transit{};
  };
  std::deque<Item> items_;  ///< [Limit: ≤ kMaxWaiting]
};

}  // namespace cairn::proto
