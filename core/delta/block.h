#pragma once

#include <array>
#include <bitset>
#include <compare>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "core/map/submap.h"

namespace cairn {

/// The unit of synchronisation: 16 × 16 cells of one layer of a submap. Even a whole block fits
/// into one frame, so that every frame can be applied alone.
struct BlockKey {
  EvidenceLayer layer = EvidenceLayer::surface;
  TileKey tile;
  std::uint8_t block = 0;  ///< (y / 16) · 4 + x / 16 within the tile. [Limit: < 16]
  friend auto operator<=>(const BlockKey&, const BlockKey&) = default;
};

struct BlockKeyHash {
  std::size_t operator()(const BlockKey& key) const;
};

inline constexpr int kBlockSize = 16;
inline constexpr int kBlockCells = kBlockSize * kBlockSize;
inline constexpr int kBlocksPerTile = 16;

/// Index within the tile of cell `i` (row by row) of a block. Requires: block < 16, i < 256.
[[nodiscard]] int index_in_tile(std::uint8_t block, int i);
/// The block of a tile that holds the tile's cell `index_in_tile`, and the cell's place in it.
struct BlockPlace {
  std::uint8_t block;
  int cell;
};
[[nodiscard]] BlockPlace place_in_block(int index_in_tile);

/// New absolute values of some cells of one block (probability 0 = unknown again).
struct BlockDelta {
  std::int32_t datum_mm = 0;  ///< Of the tile the block lies in.
  std::bitset<kBlockCells> changed;
  std::array<Cell, kBlockCells> cells{};  ///< Only those of `changed` mean anything.
};

/// The block's cells that differ between two states of a tile (either may be null: all unknown).
/// apply(base, diff(base, now)) == now.
[[nodiscard]] BlockDelta diff(const Tile* base, const Tile* now, std::uint8_t block);

/// Writes the delta's cells, making the tile with the delta's datum if a known cell needs it.
/// Applying twice changes nothing more. False, changing nothing, when a height does not fit the
/// tile's datum or HeightMap::storable. Requires: key.block < 16.
bool apply(HeightMap& map, const BlockKey& key, const BlockDelta& delta);

/// Sender's record of what changed when, for one submap: which version of a block first held the
/// present value of each cell. So a delta against *any* older version can be made, and a receiver
/// that holds any version from `base` on becomes right by applying it.
class SubmapVersions {
 public:
  /// Cells changed. A block goes to its next version when the present one was told.
  void touch(EvidenceLayer layer, const std::vector<CellIndex>& cells, std::int8_t level = 0);

  /// 0 when the block was never touched.
  [[nodiscard]] std::uint32_t version(const BlockKey& key) const;
  /// Every cell changed after version `base`, with its present value from `map`.
  [[nodiscard]] BlockDelta changes_since(const BlockKey& key, std::uint32_t base,
                                         const Submap& submap) const;
  /// As it was when it was written down: a block's present version, and the cells (all of their
  /// values, of whatever version) that were ever changed. It counts as told.
  void restore(const BlockKey& key, std::uint32_t version,
               const std::bitset<kBlockCells>& ever_changed);
  /// The block's present version goes out: what changes from now on is of the next.
  void told(const BlockKey& key);

  struct Block {
    std::uint32_t version = 0;
    bool told = true;  ///< Of its present version.
    std::array<std::uint32_t, kBlockCells> changed_at{};
  };
  using Blocks = std::unordered_map<BlockKey, Block, BlockKeyHash>;
  [[nodiscard]] const Blocks& blocks() const { return blocks_; }

 private:
  Blocks blocks_;
};

}  // namespace cairn
