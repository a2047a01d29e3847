#include "core/map/height_map.h"

#include <gtest/gtest.h>

#include <limits>

namespace cairn {
namespace {

constexpr int kCellMm = 125;

TEST(HeightMap, FindsTheCellUnderAPointAlsoWestAndSouthOfTheOrigin) {
  const HeightMap map(kCellMm);
  EXPECT_EQ(map.cell_at(0.0, 0.124), (CellIndex{0, 0}));
  EXPECT_EQ(map.cell_at(0.125, 1.0), (CellIndex{1, 8}));
  EXPECT_EQ(map.cell_at(-0.001, -0.125), (CellIndex{-1, -1}));
  EXPECT_EQ(map.cell_at(-0.126, 0.0), (CellIndex{-2, 0}));
}

TEST(HeightMap, TheMiddleOfACellLiesInIt) {
  const HeightMap map(kCellMm);
  for (const std::int32_t i : {-700'000, -65, -1, 0, 1, 64, 700'000}) {
    EXPECT_EQ(map.cell_at(map.centre_m(i), map.centre_m(-i)), (CellIndex{i, -i}));
  }
}

TEST(HeightMap, TilesMeetWithoutGapAtTheOrigin) {
  EXPECT_EQ(HeightMap::tile_of({-1, 0}), (TileKey{0, -1, 0}));
  EXPECT_EQ(HeightMap::tile_of({-64, 63}), (TileKey{0, -1, 0}));
  EXPECT_EQ(HeightMap::tile_of({-65, 64}), (TileKey{0, -2, 1}));
  EXPECT_EQ(HeightMap::index_in_tile({-1, -64}), Tile::index(63, 0));
}

TEST(HeightMap, IsUnknownWhereNothingWasSeenAndReadingMakesNoTiles) {
  const HeightMap map(kCellMm);
  EXPECT_FALSE(map.cell({1000, -1000}).known());
  EXPECT_TRUE(map.tiles().empty());
}

TEST(HeightMap, RemembersCellsPerLevel) {
  HeightMap map(kCellMm);
  EXPECT_TRUE(map.set({-3, 70}, {150, 10}));
  EXPECT_TRUE(map.set({-3, 70}, {4150, 20}, 1));
  EXPECT_EQ(map.cell({-3, 70}), (Cell{150, 10}));
  EXPECT_EQ(map.cell({-3, 70}, 1), (Cell{4150, 20}));
  EXPECT_EQ(map.known_count(), 2U);
  EXPECT_EQ(map.tiles().size(), 2U);
}

TEST(HeightMap, ATileTakesItsDatumFromItsFirstHeightRoundedToAMetre) {
  HeightMap map(kCellMm);
  EXPECT_EQ(map.make({0, 0, 0}, 1499).datum_mm(), 1000);
  EXPECT_EQ(map.make({0, 1, 0}, 1500).datum_mm(), 2000);
  EXPECT_EQ(map.make({0, 2, 0}, -1499).datum_mm(), -1000);
  EXPECT_EQ(map.make({0, 3, 0}, -1501).datum_mm(), -2000);
  EXPECT_EQ(map.make({0, 0, 0}, 9000).datum_mm(), 1000) << "made once";
}

TEST(HeightMap, HoldsHillsFarAboveAndValleysFarBelowTheOrigin) {
  HeightMap map(kCellMm);
  EXPECT_TRUE(map.set({0, 0}, {2'500'000, 99}));
  EXPECT_TRUE(map.set({64, 0}, {-400'000, 99}));
  EXPECT_EQ(map.cell({0, 0}).height_mm, 2'500'000);
  EXPECT_EQ(map.cell({64, 0}).height_mm, -400'000);
}

TEST(HeightMap, RefusesWhatItsTileCannotHoldAndKeepsTheCell) {
  HeightMap map(kCellMm);
  ASSERT_TRUE(map.set({0, 0}, {0, 99}));
  EXPECT_FALSE(map.set({0, 0}, {40'000, 99}));
  EXPECT_EQ(map.cell({0, 0}), (Cell{0, 99}));
}

TEST(HeightMap, RefusesHeightsBeyondItsExtent) {
  HeightMap map(kCellMm);
  EXPECT_FALSE(map.set({0, 0}, {std::numeric_limits<std::int32_t>::max(), 99}));
  EXPECT_FALSE(map.set({0, 0}, {std::numeric_limits<std::int32_t>::min(), 99}));
  EXPECT_TRUE(map.tiles().empty());
}

TEST(HeightMap, ForgettingMakesNoTile) {
  HeightMap map(kCellMm);
  EXPECT_TRUE(map.set({5, 5}, Cell{}));
  EXPECT_TRUE(map.tiles().empty());
  map.set({5, 5}, {10, 50});
  EXPECT_TRUE(map.set({5, 5}, Cell{}));
  EXPECT_EQ(map.known_count(), 0U);
}

TEST(HeightMap, ACopyIsIndependent) {
  HeightMap map(kCellMm);
  map.set({1, 1}, {10, 50});
  HeightMap copy = map;
  copy.set({1, 1}, {20, 60});
  EXPECT_EQ(map.cell({1, 1}), (Cell{10, 50}));
  map = copy;
  EXPECT_EQ(map.cell({1, 1}), (Cell{20, 60}));
}

TEST(HeightMap, InsertsFindsAndErasesWholeTiles) {
  HeightMap map(kCellMm);
  Tile tile(7000);
  tile.set(3, {7001, 40});
  map.insert({0, -1, 2}, tile);
  ASSERT_NE(map.find({0, -1, 2}), nullptr);
  EXPECT_EQ(*map.find({0, -1, 2}), tile);
  map.insert({0, -1, 2}, Tile(0));
  EXPECT_EQ(*map.find({0, -1, 2}), Tile(0));
  map.erase({0, -1, 2});
  EXPECT_EQ(map.find({0, -1, 2}), nullptr);
}

}  // namespace
}  // namespace cairn
