#include "robot_agent/pipeline/replica.h"

#include <gtest/gtest.h>

namespace cairn::agent {
namespace {

constexpr int kCellMm = 125;
constexpr std::size_t kPlenty = std::size_t{64} << 20U;

/// A submap that knows one cell.
Submap submap(std::uint32_t sequence, CellIndex cell, std::int32_t height_mm) {
  Submap made({1, sequence}, {}, kCellMm);
  made.surface.set(cell, {height_mm, 200});
  made.closed = true;
  return made;
}

GivenTile given(CellIndex cell, std::int32_t height_mm, std::uint32_t holds) {
  HeightMap map(kCellMm);
  map.set(cell, {height_mm, 250});
  const TileKey key = HeightMap::tile_of(cell);
  return {key, *map.find(key), holds};
}

Replica replica(std::size_t bytes = kPlenty) { return {kCellMm, SensorModel{}, bytes}; }

TEST(Replica, HoldsWhatWasAddedNowButNotYetAsOld) {
  Replica map = replica();
  map.add(submap(1, {3, 3}, 500));
  EXPECT_EQ(map.now().cell({3, 3}).height_mm, 500);
  EXPECT_FALSE(map.old().cell({3, 3}).known());
}

TEST(Replica, HoldsAsOldWhatHasAged) {
  Replica map = replica();
  map.add(submap(1, {3, 3}, 500));
  map.add(submap(2, {4, 3}, 600));
  map.age(1);
  EXPECT_EQ(map.old().cell({3, 3}).height_mm, 500);
  EXPECT_FALSE(map.old().cell({4, 3}).known());
}

TEST(Replica, LaysOwnSubmapsOnATileThatDoesNotHoldThem) {
  Replica map = replica();
  map.add(submap(1, {3, 3}, 500));
  map.add(submap(2, {4, 3}, 600));
  map.take({given({9, 9}, 100, 1)});  // Says that submap 1 is in it, and that it told nothing.
  EXPECT_FALSE(map.now().cell({3, 3}).known());
  EXPECT_EQ(map.now().cell({4, 3}).height_mm, 600);
  EXPECT_EQ(map.now().cell({9, 9}).height_mm, 100);
}

TEST(Replica, KeepsATileWithYoungSubmapsOutOfTheOldMap) {
  Replica map = replica();
  map.add(submap(1, {3, 3}, 500));
  map.take({given({9, 9}, 100, 0), given({9, 9}, 140, 1)});
  EXPECT_EQ(map.old().cell({9, 9}).height_mm, 100);
  EXPECT_EQ(map.now().cell({9, 9}).height_mm, 140);
  map.age(1);
  EXPECT_EQ(map.old().cell({9, 9}).height_mm, 140);
}

TEST(Replica, MovesASubmapWithoutATrace) {
  Replica map = replica();
  map.add(submap(1, {3, 3}, 500));
  map.add(submap(2, {4, 3}, 600));
  map.age(2);
  map.move({{1, {.x_mm = 100 * kCellMm, .z_mm = 50}}});
  for (const HeightMap* layer : {&map.now(), &map.old()}) {
    EXPECT_FALSE(layer->cell({3, 3}).known());
    EXPECT_EQ(layer->cell({103, 3}).height_mm, 550);
    EXPECT_EQ(layer->cell({4, 3}).height_mm, 600);
  }
}

TEST(Replica, FallsBackToTheTileOfBeforeWhereAMovedSubmapWasInTheNewerOne) {
  Replica map = replica();
  map.take({given({9, 9}, 100, 0)});
  map.add(submap(1, {3, 3}, 500));
  map.take({given({3, 3}, 500, 1)});
  map.move({{1, {.x_mm = kCellMm}}});
  EXPECT_FALSE(map.now().cell({3, 3}).known());
  EXPECT_EQ(map.now().cell({4, 3}).height_mm, 500);
  EXPECT_EQ(map.now().cell({9, 9}).height_mm, 100);
}

TEST(Replica, MovesNothingThatItDoesNotKeep) {
  Replica map = replica();
  map.add(submap(1, {3, 3}, 500));
  map.move({{7, {.x_mm = kCellMm}}});
  EXPECT_EQ(map.now().cell({3, 3}).height_mm, 500);
}

TEST(Replica, FixesTheOldestSubmapsBeyondItsBytesAndStillKnowsWhatTheySaw) {
  Replica map = replica(2 * sizeof(Tile));
  for (std::uint32_t i = 1; i <= 5; ++i) {
    map.add(submap(i, {static_cast<std::int32_t>(i), 0}, 100));
  }
  EXPECT_EQ(map.submaps(), 2U);
  EXPECT_EQ(map.find(3), nullptr);
  map.move({{5, {.y_mm = kCellMm}}});  // Lays the tile anew.
  for (std::int32_t x = 1; x <= 4; ++x) EXPECT_TRUE(map.now().cell({x, 0}).known()) << x;
  EXPECT_TRUE(map.now().cell({5, 1}).known());
  EXPECT_FALSE(map.now().cell({5, 0}).known());
}

TEST(Replica, ForgetsWhatIsFar) {
  Replica map = replica();
  map.add(submap(1, {3, 3}, 500));
  map.take({given({3, 3}, 480, 1), given({1000, 3}, 100, 0)});
  map.forget_beyond(0.0, 0.0, 50.0);
  EXPECT_TRUE(map.now().cell({3, 3}).known());
  EXPECT_FALSE(map.now().cell({1000, 3}).known());
  EXPECT_FALSE(map.given_at(125.0, 0.4));
}

TEST(Replica, TellsWhatWasGivenFromWhatItMadeItself) {
  Replica map = replica();
  map.take({given({3, 3}, 480, 0), given({100, 3}, 480, 2)});
  EXPECT_TRUE(map.given_at(0.4, 0.4));
  EXPECT_FALSE(map.given_at(12.6, 0.4));
  EXPECT_FALSE(map.given_at(-0.4, 0.4));
}

}  // namespace
}  // namespace cairn::agent
