#include "core/map/tile.h"

#include <gtest/gtest.h>

#include <unordered_set>

namespace cairn {
namespace {

TEST(Tile, StartsUnknownEverywhere) {
  const Tile tile(3000);
  EXPECT_EQ(tile.known_count(), 0);
  for (int i = 0; i < Tile::kCells; ++i) ASSERT_FALSE(tile.known(i));
}

TEST(Tile, GivesBackWhatWasSet) {
  Tile tile(3000);
  const int i = Tile::index(5, 63);
  tile.set(i, {2980, 200});
  EXPECT_EQ(tile.cell(i), (Cell{2980, 200}));
  EXPECT_TRUE(tile.known(i));
  EXPECT_EQ(tile.known_count(), 1);
  EXPECT_FALSE(tile.known(Tile::index(63, 5)));
}

TEST(Tile, HoldsHeightsUpToItsLimitAroundTheDatum) {
  Tile tile(-500'000);
  for (const std::int32_t height : {-500'000 + 32'767, -500'000 - 32'767}) {
    ASSERT_TRUE(tile.representable(height));
    tile.set(0, {height, 1});
    EXPECT_EQ(tile.height_mm(0), height);
  }
  EXPECT_FALSE(tile.representable(-500'000 + 32'768));
  EXPECT_FALSE(tile.representable(-500'000 - 32'768));
  EXPECT_FALSE(Tile(-2'000'000'000).representable(2'000'000'000)) << "no overflow";
}

TEST(Tile, ForgetsTheHeightOfACellThatBecameUnknownSoThatEqualMapsAreEqual) {
  Tile tile(0);
  tile.set(7, {1234, 90});
  EXPECT_NE(tile, Tile(0));
  tile.set(7, {1234, 0});
  EXPECT_EQ(tile, Tile(0));
}

TEST(Tile, AnUnknownCellMayHaveAnyHeight) {
  Tile tile(0);
  tile.set(7, {2'000'000'000, 0});
  EXPECT_EQ(tile, Tile(0));
}

TEST(TileKey, OrdersByLevelThenColumnThenRow) {
  EXPECT_LT((TileKey{0, 5, 5}), (TileKey{1, 0, 0}));
  EXPECT_LT((TileKey{0, -1, 5}), (TileKey{0, 0, 0}));
  EXPECT_LT((TileKey{0, 0, -1}), (TileKey{0, 0, 0}));
}

TEST(TileKeyHash, KeepsTheTilesOfASiteApart) {
  std::unordered_set<std::size_t> buckets;
  constexpr int kTiles = 2 * 64 * 64;
  for (std::int8_t level = 0; level < 2; ++level) {
    for (std::int32_t x = -32; x < 32; ++x) {
      for (std::int32_t y = -32; y < 32; ++y) buckets.insert(TileKeyHash{}({level, x, y}) % 65536);
    }
  }
  // Thrown at random into 65536 buckets, 8192 keys would fill about 7700.
  EXPECT_GT(buckets.size(), kTiles * 9 / 10);
}

}  // namespace
}  // namespace cairn
