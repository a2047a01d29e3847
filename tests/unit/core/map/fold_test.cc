#include "core/map/fold.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace cairn {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kCellMm = 125;
constexpr std::uint8_t kSure = 230;

Submap submap_at(const SubmapPose& pose) { return {{1, 1}, pose, kCellMm}; }

Submap submap_with(const SubmapPose& pose, CellIndex cell, const Cell& value) {
  Submap submap = submap_at(pose);
  EXPECT_TRUE(submap.surface.set(cell, value));
  return submap;
}

/// The site's cell (0, 0) after it held `stored` and a submap there said `surface` and `seen`.
Cell folded(const Cell& stored, const Cell& surface, const Cell& seen = {}) {
  HeightMap site(kCellMm);
  EXPECT_TRUE(site.set({0, 0}, stored));
  Submap submap = submap_with({}, {0, 0}, surface);
  EXPECT_TRUE(submap.seen_through.set({0, 0}, seen));
  fold(site, submap, SensorModel{});
  return site.cell({0, 0});
}

/// Cells alone: the same whatever datum a tile was made with.
void expect_same_cells(const HeightMap& a, const HeightMap& b) {
  ASSERT_EQ(a.known_count(), b.known_count());
  for (const auto& [key, tile] : a.tiles()) {
    const Tile* other = b.find(key);
    for (int i = 0; i < Tile::kCells; ++i) {
      if (!tile->known(i)) continue;
      ASSERT_NE(other, nullptr);
      ASSERT_EQ(tile->cell(i), other->cell(i));
    }
  }
}

void scatter(HeightMap& map, std::mt19937& random, int cells) {
  for (int i = 0; i < cells; ++i) {
    const CellIndex cell{static_cast<int>(random() % 200) - 100,
                         static_cast<int>(random() % 200) - 100};
    map.set(cell, {static_cast<int>(random() % 2000) - 1000,
                   static_cast<std::uint8_t>(30 + random() % 220)});
  }
}

TEST(Fold, LearnsWhatTheSiteDidNotKnow) { EXPECT_EQ(folded({}, {420, kSure}), (Cell{420, kSure})); }

TEST(Fold, ReplacesALowerSurface) { EXPECT_EQ(folded({100, 240}, {151, 170}), (Cell{151, 170})); }

TEST(Fold, IgnoresALowerReading) { EXPECT_EQ(folded({151, 170}, {100, 240}), (Cell{151, 170})); }

TEST(Fold, CombinesReadingsOfTheSameSurface) {
  const Cell cell = folded({100, 166}, {130, 166});
  EXPECT_EQ(cell.height_mm, 115);  // One hit each.
  EXPECT_EQ(cell.probability, combine(166, 166));
}

TEST(Fold, WeighsHeightsByTheHitsBehindThem) {
  const SensorModel model;
  const int hits = hits_behind(250, model);
  ASSERT_EQ(hits, 12);
  EXPECT_EQ(folded({0, 250}, {39, 166}), (Cell{3, 250}));
  EXPECT_EQ(folded({0, 166}, {39, 250}), (Cell{36, 250}));
  EXPECT_EQ(folded({0, 166}, {-39, 250}), (Cell{-36, 250}));
}

TEST(Fold, NeverBecomesCertain) {
  EXPECT_EQ(folded({0, 250}, {0, 250}).probability, SensorModel{}.max_probability);
  EXPECT_EQ(folded({}, {0, 255}).probability, SensorModel{}.max_probability);
}

TEST(Fold, UnlearnsARemovedObjectAndLearnsWhatStoodBehindIt) {
  const Cell box{900, 200};
  EXPECT_EQ(folded(box, {}, {100, 166}), (Cell{900, combine(200, 89)}));
  EXPECT_FALSE(folded(box, {}, {100, 254}).known());
  EXPECT_EQ(folded(box, {0, 220}, {100, 254}), (Cell{0, 220}));
}

TEST(Fold, KeepsASurfaceThatBeamsPassedAbove) {
  EXPECT_EQ(folded({900, 200}, {}, {850, 254}), (Cell{900, 200}));
  EXPECT_EQ(folded({900, 200}, {}, {1200, 254}), (Cell{900, 200}));
}

TEST(Fold, NeverBelievesMoreInWhatWasSeenThrough) {
  EXPECT_EQ(folded({900, 200}, {}, {100, 60}), (Cell{900, 200}));
}

TEST(Fold, RemovedObjectIsForgottenOverSeveralWeakSubmaps) {
  HeightMap site(kCellMm);
  site.set({0, 0}, {900, 250});
  Submap submap = submap_at({});
  submap.seen_through.set({0, 0}, {100, 166});
  int folds = 0;
  while (site.cell({0, 0}).known() && folds < 20) {
    fold(site, submap, SensorModel{});
    ++folds;
  }
  EXPECT_GT(folds, 3);
  EXPECT_LT(folds, 12);
}

TEST(Fold, ShiftsByWholeCellsExactly) {
  std::mt19937 random(3);
  Submap submap = submap_at({-7 * kCellMm, 130 * kCellMm, 250, 0});
  scatter(submap.surface, random, 2000);
  HeightMap site(kCellMm);
  const auto changed = fold(site, submap, SensorModel{});
  EXPECT_FALSE(changed.empty());
  EXPECT_EQ(site.known_count(), submap.surface.known_count());
  for (int y = -100; y < 100; ++y) {
    for (int x = -100; x < 100; ++x) {
      Cell cell = submap.surface.cell({x, y});
      if (!cell.known()) continue;
      cell.height_mm += 250;
      ASSERT_EQ(site.cell({x - 7, y + 130}), cell) << x << " " << y;
    }
  }
}

TEST(Fold, TakesTheSubmapsCellUnderTheMiddle) {
  // 60 mm east: the middle of the site's cell 0 lies 2.5 mm inside the submap's cell 0.
  HeightMap site(kCellMm);
  fold(site, submap_with({60, 0, 0, 0}, {0, 0}, {5, kSure}), SensorModel{});
  EXPECT_TRUE(site.cell({0, 0}).known());
  // 63 mm: half a millimetre outside.
  HeightMap shifted(kCellMm);
  fold(shifted, submap_with({63, 0, 0, 0}, {0, 0}, {5, kSure}), SensorModel{});
  EXPECT_FALSE(shifted.cell({0, 0}).known());
  EXPECT_TRUE(shifted.cell({1, 0}).known());
}

TEST(Fold, TurnsASubmapAboutItsOrigin) {
  HeightMap site(kCellMm);
  // A quarter turn takes the cell three east to three north (and one west of the axis).
  fold(site, submap_with({0, 0, 0, 15708}, {3, 0}, {5, kSure}), SensorModel{});
  EXPECT_TRUE(site.cell({-1, 3}).known());
  EXPECT_EQ(site.known_count(), 1U);
}

TEST(Fold, LeavesNoHolesInATurnedFloor) {
  Submap submap = submap_at({333, -777, 0, 5000});
  for (int y = -40; y < 40; ++y) {
    for (int x = -40; x < 40; ++x) submap.surface.set({x, y}, {0, kSure});
  }
  HeightMap site(kCellMm);
  fold(site, submap, SensorModel{});
  for (int y = -20; y < 15; ++y) {
    for (int x = -20; x < 25; ++x) EXPECT_TRUE(site.cell({x, y}).known()) << x << " " << y;
  }
}

TEST(Fold, OfDisjointSubmapsIsTheSameInAnyOrder) {
  std::mt19937 random(11);
  Submap west = submap_at({-100 * kCellMm, 0, 0, 0});
  Submap east = submap_at({100 * kCellMm, 0, 1000, 0});
  scatter(west.surface, random, 500);
  scatter(east.surface, random, 500);
  HeightMap west_first(kCellMm);
  fold(west_first, west, SensorModel{});
  fold(west_first, east, SensorModel{});
  HeightMap east_first(kCellMm);
  fold(east_first, east, SensorModel{});
  fold(east_first, west, SensorModel{});
  expect_same_cells(west_first, east_first);
}

TEST(Fold, TileByTileInAnyOrderIsTheWholeFold) {
  std::mt19937 random(5);
  Submap submap = submap_at({1234, -4321, 77, -12345});
  scatter(submap.surface, random, 4000);
  scatter(submap.seen_through, random, 4000);
  HeightMap whole(kCellMm);
  scatter(whole, random, 4000);
  HeightMap parts = whole;
  const auto changed = fold(whole, submap, SensorModel{});
  auto keys = touched_tiles(submap);
  std::shuffle(keys.begin(), keys.end(), random);
  std::vector<TileKey> changed_parts;
  for (const TileKey& key : keys) {
    std::optional<Tile> tile;
    if (parts.find(key) != nullptr) tile = *parts.find(key);
    if (!fold_into_tile(tile, key, submap, SensorModel{})) continue;
    changed_parts.push_back(key);
    parts.insert(key, *tile);
  }
  std::sort(changed_parts.begin(), changed_parts.end());
  EXPECT_EQ(changed_parts, changed);
  for (const auto& [key, tile] : whole.tiles()) EXPECT_EQ(*tile, *parts.find(key));
}

TEST(Fold, SaysWhenNothingChanged) {
  HeightMap site(kCellMm);
  const Submap submap = submap_with({}, {70, 3}, {5, 250});
  EXPECT_THAT(fold(site, submap, SensorModel{}), ElementsAre(TileKey{0, 1, 0}));
  EXPECT_THAT(fold(site, submap, SensorModel{}), IsEmpty());
  EXPECT_THAT(fold(site, submap_at({}), SensorModel{}), IsEmpty());
}

TEST(Fold, KeepsToTheLevel) {
  HeightMap site(kCellMm);
  Submap submap = submap_at({});
  submap.surface.set({0, 0}, {5, kSure}, 2);
  EXPECT_THAT(fold(site, submap, SensorModel{}), ElementsAre(TileKey{2, 0, 0}));
  EXPECT_EQ(site.cell({0, 0}, 2), (Cell{5, kSure}));
  EXPECT_FALSE(site.cell({0, 0}, 0).known());
}

TEST(Fold, MakesATileWithTheDatumOfItsFirstHeight) {
  HeightMap site(kCellMm);
  fold(site, submap_with({0, 0, 40'000, 0}, {0, 0}, {700, kSure}), SensorModel{});
  EXPECT_EQ(site.find({0, 0, 0})->datum_mm(), 41'000);
}

TEST(Fold, SkipsHeightsThatTheTileCannotHold) {
  EXPECT_EQ(folded({0, 200}, {32'768, 200}), (Cell{0, 200}));
  HeightMap site(kCellMm);
  EXPECT_THAT(fold(site, submap_with({0, 0, 99'999'999, 0}, {0, 0}, {30'000, 200}), SensorModel{}),
              IsEmpty());
}

TEST(Fold, RefusesPosesAndTilesBeyondTheEarth) {
  constexpr auto kFar = std::numeric_limits<std::int32_t>::max();
  HeightMap site(kCellMm);
  EXPECT_THAT(fold(site, submap_with({kFar, 0, 0, 0}, {0, 0}, {0, kSure}), SensorModel{}),
              IsEmpty());
  EXPECT_THAT(fold(site, submap_with({0, 0, -kFar, 0}, {0, 0}, {0, kSure}), SensorModel{}),
              IsEmpty());
  Submap far = submap_at({0, 0, 0, 777});
  Tile tile(0);
  tile.set(0, {0, kSure});
  far.surface.insert({0, kFar, -kFar}, tile);
  EXPECT_THAT(touched_tiles(far), IsEmpty());
  std::optional<Tile> none;
  EXPECT_FALSE(fold_into_tile(none, {0, kFar, kFar}, far, SensorModel{}));
}

TEST(TouchedTiles, OfAnUnturnedSubmapAreThoseUnderIt) {
  EXPECT_THAT(touched_tiles(submap_with({}, {0, 0}, {0, kSure})), ElementsAre(TileKey{0, 0, 0}));
  EXPECT_THAT(touched_tiles(submap_with({64 * kCellMm, -64 * kCellMm, 0, 0}, {0, 0}, {0, kSure})),
              ElementsAre(TileKey{0, 1, -1}));
  EXPECT_THAT(touched_tiles(submap_with({kCellMm, 0, 0, 0}, {0, 0}, {0, kSure})),
              ElementsAre(TileKey{0, 0, 0}, TileKey{0, 1, 0}));
}

TEST(TouchedTiles, HoldEveryCellThatAFoldWrites) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto any = [&](int limit) { return static_cast<int>(random() % (2U * limit)) - limit; };
    Submap submap = submap_at({any(20'000), any(20'000), 0, any(31'416)});
    Tile full(0);
    for (int i = 0; i < Tile::kCells; ++i) full.set(i, {0, kSure});
    submap.surface.insert({0, 0, 0}, full);
    const auto keys = touched_tiles(submap);
    HeightMap site(kCellMm);
    for (int ty = -6; ty <= 6; ++ty) {
      for (int tx = -6; tx <= 6; ++tx) {
        std::optional<Tile> tile;
        const TileKey key{0, tx, ty};
        if (!fold_into_tile(tile, key, submap, SensorModel{})) continue;
        EXPECT_TRUE(std::binary_search(keys.begin(), keys.end(), key));
      }
    }
  }
}

}  // namespace
}  // namespace cairn
