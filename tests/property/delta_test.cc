#include <gtest/gtest.h>

#include <random>

#include "core/delta/block.h"

namespace cairn {
namespace {

constexpr TileKey kTile{0, -1, 0};
constexpr CellIndex kCorner{-Tile::kSize, 0};

std::uint8_t block_number(int block) { return static_cast<std::uint8_t>(block); }

Cell random_cell(std::mt19937& random, std::int32_t datum_mm) {
  // Few values, so that cells also change back.
  if (random() % 4 == 0) return {};
  return {datum_mm + static_cast<int>(random() % 3) - 1,
          static_cast<std::uint8_t>(100 + random() % 2)};
}

Tile random_tile(std::mt19937& random, std::int32_t datum_mm) {
  Tile tile(datum_mm);
  const auto one_in = 1 + random() % 50;
  for (int i = 0; i < Tile::kCells; ++i) {
    if (random() % one_in == 0) tile.set(i, random_cell(random, datum_mm));
  }
  return tile;
}

bool same_cells(const Tile* a, const Tile* b) {
  for (int block = 0; block < kBlocksPerTile; ++block) {
    if (diff(a, b, block_number(block)).changed.any()) return false;
  }
  return true;
}

TEST(DeltaProperty, ApplyingADifferenceGivesTheNewTile) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const std::int32_t datum_mm = static_cast<std::int32_t>(random() % 100'000) - 50'000;
    const Tile base = random_tile(random, datum_mm);
    const Tile now = random_tile(random, datum_mm);
    const bool from_nothing = random() % 4 == 0;
    HeightMap map(125);
    if (!from_nothing) map.insert(kTile, base);
    for (int block = 0; block < kBlocksPerTile; ++block) {
      const BlockDelta delta = diff(from_nothing ? nullptr : &base, &now, block_number(block));
      ASSERT_TRUE(apply(map, {EvidenceLayer::surface, kTile, block_number(block)}, delta));
    }
    if (now.known_count() > 0) {
      ASSERT_EQ(*map.find(kTile), now);
    }
    ASSERT_TRUE(same_cells(map.find(kTile), &now));
  }
}

/// A sender that changes cells at random and remembers what one block looked like at each version.
class Sender {
 public:
  explicit Sender(unsigned seed) : random(seed) { remember(); }

  void change() {
    std::vector<CellIndex> cells;
    const auto count = 1 + random() % 8;
    for (std::size_t i = 0; i < count; ++i) {
      const CellIndex cell{kCorner.x + static_cast<int>(random() % 5),
                           kCorner.y + static_cast<int>(random() % 5)};
      submap.surface.set(cell, random_cell(random, 7000));
      cells.push_back(cell);
    }
    versions.told(key);
    versions.touch(EvidenceLayer::surface, cells);
    remember();
  }

  [[nodiscard]] std::uint32_t now() const { return versions.version(key); }

  const BlockKey key{EvidenceLayer::surface, kTile, 0};
  std::mt19937 random;
  Submap submap{{1, 1}, {}, 125};
  SubmapVersions versions;
  std::vector<HeightMap> states;  ///< By version.

 private:
  void remember() { states.push_back(submap.surface); }
};

TEST(DeltaProperty, AReceiverOfAnyVersionFromTheBaseOnBecomesEqual) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Sender sender(seed);
    for (int i = 0; i < 20; ++i) sender.change();
    for (std::uint32_t base = 0; base <= sender.now(); ++base) {
      const BlockDelta delta = sender.versions.changes_since(sender.key, base, sender.submap);
      for (std::uint32_t held = base; held <= sender.now(); ++held) {
        HeightMap receiver = sender.states[held];
        ASSERT_TRUE(apply(receiver, sender.key, delta));
        ASSERT_TRUE(same_cells(receiver.find(kTile), sender.submap.surface.find(kTile)))
            << "base " << base << ", held " << held;
      }
    }
  }
}

TEST(DeltaProperty, LostAndRepeatedDeltasEndInTheSameTile) {
  for (unsigned seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Sender sender(seed);
    HeightMap receiver(125);
    std::uint32_t acknowledged = 0;
    for (int round = 0; round < 12; ++round) {
      sender.change();
      const BlockDelta delta =
          sender.versions.changes_since(sender.key, acknowledged, sender.submap);
      if (sender.random() % 3 == 0) continue;  // The delta is lost.
      ASSERT_TRUE(apply(receiver, sender.key, delta));
      if (sender.random() % 3 == 0) continue;  // Its acknowledgement is lost.
      acknowledged = sender.now();
    }
    const BlockDelta last = sender.versions.changes_since(sender.key, acknowledged, sender.submap);
    ASSERT_TRUE(apply(receiver, sender.key, last));
    ASSERT_TRUE(same_cells(receiver.find(kTile), sender.submap.surface.find(kTile)));
  }
}

}  // namespace
}  // namespace cairn
