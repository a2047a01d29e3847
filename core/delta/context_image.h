#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/delta/block.h"

namespace cairn {

/// What was told of a block, without room for what was not.
struct ToldBlock {
  BlockKey key;
  std::uint32_t version = 0;
  std::int32_t datum_mm = 0;
  /// Place in the block and new value, ascending. [Limit: ≤ kBlockCells]
  std::vector<std::pair<std::uint8_t, Cell>> cells;
};
[[nodiscard]] ToldBlock told_block(const BlockKey& key, std::uint32_t version,
                                   const BlockDelta& delta);

/// What both ends of a link provably hold of the submaps under way: the common ground on which the
/// next changes are told. It only lends statistics and predictions; what is told are absolute
/// values, so that nothing that is merged depends on it. Two images that took the same blocks in
/// the same order are equal.
class ContextImage {
 public:
  struct SeenCell {
    std::int32_t height_mm = 0;
    std::uint8_t probability = 0;  ///< [1/255] 0 = unknown.
    std::uint8_t tick = 0;         ///< Of its last change, as the update named it.
    std::uint8_t updates = 0;      ///< Changes since it was last unknown, saturating.
    friend bool operator==(const SeenCell&, const SeenCell&) = default;
  };
  struct Block {
    std::uint32_t version = 0;
    std::int32_t datum_mm = 0;
    std::uint8_t tick = 0;
    std::array<SeenCell, kBlockCells> cells{};
  };

  /// Takes what was told of a block at `tick`, unless it holds it as new already. The oldest submap
  /// is forgotten when there are too many or too large ones.
  void merge(std::uint32_t sequence, const ToldBlock& told, std::uint8_t tick);
  /// Null when nothing of it was merged, or it was forgotten. Valid until the next merge.
  [[nodiscard]] const Block* find(std::uint32_t sequence, const BlockKey& key) const;
  void clear();
  [[nodiscard]] std::size_t blocks() const { return blocks_; }

  static constexpr std::size_t kMaxBlocks = 4096;  ///< 8 MB.
  static constexpr std::size_t kMaxSubmaps = 4;

 private:
  /// Sequences with the highest bit set name submaps of earlier boots: older than any other.
  struct Older {
    bool operator()(std::uint32_t a, std::uint32_t b) const {
      return static_cast<std::int32_t>(a) < static_cast<std::int32_t>(b);
    }
  };
  using Blocks = std::unordered_map<BlockKey, std::unique_ptr<Block>, BlockKeyHash>;

  Block& make(std::uint32_t sequence, const BlockKey& key);
  void forget_oldest();

  std::map<std::uint32_t, Blocks, Older> submaps_;  ///< [Limit: ≤ kMaxSubmaps]
  std::size_t blocks_ = 0;                          ///< [Limit: ≤ kMaxBlocks]
};

/// A cell of the image after one more change.
[[nodiscard]] ContextImage::SeenCell after_change(const ContextImage::SeenCell& before,
                                                  const Cell& now, std::uint8_t tick);

}  // namespace cairn
