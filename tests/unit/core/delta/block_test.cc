#include "core/delta/block.h"

#include <gtest/gtest.h>

#include <limits>

namespace cairn {
namespace {

const BlockKey kFirstBlock{EvidenceLayer::surface, {0, 0, 0}, 0};

TEST(Block, NumbersTheCellsOfATileOnceEach) {
  std::bitset<Tile::kCells> seen;
  for (int block = 0; block < kBlocksPerTile; ++block) {
    for (int i = 0; i < kBlockCells; ++i) {
      const int cell = index_in_tile(static_cast<std::uint8_t>(block), i);
      seen.set(static_cast<std::size_t>(cell));
      EXPECT_EQ(place_in_block(cell).block, block);
      EXPECT_EQ(place_in_block(cell).cell, i);
    }
  }
  EXPECT_TRUE(seen.all());
}

TEST(Block, LiesRowByRowFromTheSouthWest) {
  EXPECT_EQ(index_in_tile(1, 0), Tile::index(16, 0));
  EXPECT_EQ(index_in_tile(4, 17), Tile::index(1, 17));
  EXPECT_EQ(index_in_tile(15, 255), Tile::index(63, 63));
}

TEST(Diff, OfTwoUnknownTilesIsEmpty) {
  EXPECT_TRUE(diff(nullptr, nullptr, 3).changed.none());
  const Tile unknown(5000);
  EXPECT_TRUE(diff(&unknown, nullptr, 3).changed.none());
  EXPECT_TRUE(diff(nullptr, &unknown, 3).changed.none());
}

TEST(Diff, HoldsWhatChangedInItsBlockAlone) {
  Tile base(1000);
  base.set(index_in_tile(2, 7), {900, 100});
  base.set(index_in_tile(2, 8), {900, 100});
  Tile now = base;
  now.set(index_in_tile(2, 8), {});
  now.set(index_in_tile(2, 9), {1100, 50});
  now.set(index_in_tile(3, 9), {1100, 50});
  const BlockDelta delta = diff(&base, &now, 2);
  EXPECT_EQ(delta.datum_mm, 1000);
  EXPECT_EQ(delta.changed.count(), 2U);
  EXPECT_FALSE(delta.cells[8].known());
  EXPECT_EQ(delta.cells[9], (Cell{1100, 50}));
}

TEST(Apply, MakesTheTileWithTheSendersDatum) {
  HeightMap map(125);
  BlockDelta delta;
  delta.datum_mm = 12'345;
  delta.changed.set(3);
  delta.cells[3] = {12'000, 77};
  EXPECT_TRUE(apply(map, kFirstBlock, delta));
  EXPECT_EQ(map.find(kFirstBlock.tile)->datum_mm(), 12'345);
  EXPECT_EQ(map.cell({3, 0}), (Cell{12'000, 77}));
}

TEST(Apply, TwiceIsTheSameAsOnce) {
  HeightMap map(125);
  BlockDelta delta;
  delta.changed.set(3);
  delta.cells[3] = {5, 77};
  apply(map, kFirstBlock, delta);
  const Tile once = *map.find(kFirstBlock.tile);
  EXPECT_TRUE(apply(map, kFirstBlock, delta));
  EXPECT_EQ(*map.find(kFirstBlock.tile), once);
}

TEST(Apply, MakesNoTileForUnknownCells) {
  HeightMap map(125);
  BlockDelta delta;
  delta.changed.set();
  EXPECT_TRUE(apply(map, kFirstBlock, delta));
  EXPECT_TRUE(map.tiles().empty());
}

TEST(Apply, RefusesHeightsThatDoNotFitAndChangesNothing) {
  HeightMap map(125);
  ASSERT_TRUE(map.set({0, 0}, {10, 100}));
  BlockDelta delta;
  delta.changed.set(0);
  delta.changed.set(1);
  delta.cells[0] = {20, 100};
  delta.cells[1] = {32'768, 100};
  EXPECT_FALSE(apply(map, kFirstBlock, delta));
  EXPECT_EQ(map.cell({0, 0}), (Cell{10, 100}));
  delta.cells[1] = {std::numeric_limits<std::int32_t>::min(), 100};
  EXPECT_FALSE(apply(map, kFirstBlock, delta));
}

TEST(Apply, RefusesADatumNoMapCanHold) {
  HeightMap map(125);
  BlockDelta delta;
  delta.datum_mm = std::numeric_limits<std::int32_t>::max();
  delta.changed.set(0);
  delta.cells[0] = {delta.datum_mm, 100};
  EXPECT_FALSE(apply(map, kFirstBlock, delta));
  EXPECT_TRUE(map.tiles().empty());
}

TEST(SubmapVersions, RaiseABlockOnceForAllCellsTouchedTogether) {
  SubmapVersions versions;
  EXPECT_EQ(versions.version(kFirstBlock), 0U);
  versions.touch(EvidenceLayer::surface, {{0, 0}, {1, 0}, {0, 0}, {20, 0}});
  EXPECT_EQ(versions.version(kFirstBlock), 1U);
  versions.told(kFirstBlock);
  versions.touch(EvidenceLayer::surface, {{15, 15}});
  EXPECT_EQ(versions.version(kFirstBlock), 2U);
  EXPECT_EQ(versions.version({EvidenceLayer::surface, {0, 0, 0}, 1}), 1U);
  EXPECT_EQ(versions.version({EvidenceLayer::seen_through, {0, 0, 0}, 0}), 0U);
  EXPECT_EQ(versions.blocks().size(), 2U);
}

TEST(SubmapVersions, StayUntilTold) {
  SubmapVersions versions;
  for (int i = 0; i < 5; ++i) versions.touch(EvidenceLayer::surface, {{i, 0}});
  EXPECT_EQ(versions.version(kFirstBlock), 1U);
  versions.told(kFirstBlock);
  versions.told(kFirstBlock);
  EXPECT_EQ(versions.version(kFirstBlock), 1U);
}

TEST(SubmapVersions, TellTilesAndLevelsApart) {
  SubmapVersions versions;
  versions.touch(EvidenceLayer::seen_through, {{-1, -1}}, 3);
  EXPECT_EQ(versions.version({EvidenceLayer::seen_through, {3, -1, -1}, 15}), 1U);
  EXPECT_EQ(versions.version({EvidenceLayer::seen_through, {0, -1, -1}, 15}), 0U);
}

TEST(SubmapVersions, SendOnlyWhatCameAfterTheBase) {
  Submap submap({1, 1}, {}, 125);
  SubmapVersions versions;
  submap.surface.set({0, 0}, {2000, 100});
  versions.touch(EvidenceLayer::surface, {{0, 0}});
  versions.told(kFirstBlock);
  submap.surface.set({1, 0}, {2010, 100});
  versions.touch(EvidenceLayer::surface, {{1, 0}});
  const BlockDelta delta = versions.changes_since(kFirstBlock, 1, submap);
  EXPECT_EQ(delta.datum_mm, 2000);
  EXPECT_EQ(delta.changed.count(), 1U);
  EXPECT_EQ(delta.cells[1], (Cell{2010, 100}));
  EXPECT_EQ(versions.changes_since(kFirstBlock, 0, submap).changed.count(), 2U);
  EXPECT_TRUE(versions.changes_since(kFirstBlock, 2, submap).changed.none());
}

TEST(SubmapVersions, SendACellThatChangedAndChangedBack) {
  Submap submap({1, 1}, {}, 125);
  SubmapVersions versions;
  submap.surface.set({0, 0}, {10, 100});
  versions.touch(EvidenceLayer::surface, {{0, 0}});
  submap.surface.set({0, 0}, {});
  versions.touch(EvidenceLayer::surface, {{0, 0}});
  EXPECT_TRUE(versions.changes_since(kFirstBlock, 0, submap).changed.test(0));
}

}  // namespace
}  // namespace cairn
