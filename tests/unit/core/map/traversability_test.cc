#include "core/map/traversability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/support/ascii_grid.h"

namespace cairn {
namespace {

using test::draw;
using test::picture;
using Rows = std::vector<std::string>;

constexpr VehicleLimits kTenCentimetres{100, 100, 0.35};

Rows classes_of(const Rows& rows, const VehicleLimits& limits, int step_mm = 100) {
  const auto drawn = draw(rows, step_mm);
  return picture(drawn.grid, classify(drawn.grid, limits));
}

TEST(Classify, MarksACliffAtItsTopAndNotAtItsBottom) {
  EXPECT_EQ(classes_of({"555000",  //
                        "555000",  //
                        "555000"},
                       kTenCentimetres),
            (Rows{"..#...",  //
                  "..#...",  //
                  "..#..."}));
}

TEST(Classify, SeesACornerOfACliffDiagonally) {
  EXPECT_EQ(classes_of({"555",  //
                        "555",  //
                        "550"},
                       kTenCentimetres),
            (Rows{"...",  //
                  ".##",  //
                  ".#."}));
}

TEST(Classify, LeavesARampBelowTheClimbHeightFree) {
  EXPECT_EQ(classes_of({"0123456789"}, kTenCentimetres), (Rows{".........."}));
  EXPECT_EQ(classes_of({"0123456789"}, kTenCentimetres, 101), (Rows{".#########"}));
}

TEST(Classify, IgnoresUnknownNeighbours) {
  EXPECT_EQ(classes_of({"5?0",  //
                        "???",  //
                        "0?5"},
                       kTenCentimetres),
            (Rows{".?.",  //
                  "???",  //
                  ".?."}));
}

TEST(Classify, LeavesAStepFreeThatCanBeTakenOneWayOnly) {
  EXPECT_EQ(classes_of({"0022"}, {50, 200, 0.35}), (Rows{"...."}));
  EXPECT_EQ(classes_of({"0033"}, {50, 200, 0.35}), (Rows{"..#."}));
  EXPECT_EQ(classes_of({"0033"}, {300, 50, 0.35}), (Rows{"...."}));
}

TEST(Classify, DoesNotOverflowAtTheEndsOfTheHeights) {
  auto drawn = draw({"..", ".."});
  drawn.grid.height_mm = {
      std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max(),
      std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()};
  EXPECT_EQ(picture(drawn.grid, classify(drawn.grid, kTenCentimetres)), (Rows{"#.", ".#"}));
  const VehicleLimits anything{std::numeric_limits<std::int32_t>::max(), 0, 0};
  EXPECT_EQ(picture(drawn.grid, classify(drawn.grid, anything)), (Rows{"#.", ".#"}));
}

TEST(Classify, SeesAStepThatTheGridHasCutInTwo) {
  EXPECT_EQ(classes_of({"22100", "22100", "22100"}, kTenCentimetres, 65),
            (Rows{".##..", ".##..", ".##.."}));
  EXPECT_EQ(classes_of({"000", "000", "111", "222", "222"}, kTenCentimetres, 65),
            (Rows{"...", "...", "###", "###", "..."}));
  EXPECT_EQ(classes_of({"22100"}, kTenCentimetres, 50), (Rows{"....."}));
}

TEST(Classify, KeepsTheLowerHalfFreeWhereTheEdgeLiesAboveIt) {
  EXPECT_EQ(classes_of({"5510"}, kTenCentimetres, 25), (Rows{".#.."}));  // 100 mm, then 25.
}

TEST(Classify, KnowsTheFootAndTheCrestOfARampFromAStep) {
  EXPECT_EQ(classes_of({"0001234555"}, kTenCentimetres, 60), (Rows{".........."}));
  EXPECT_EQ(classes_of({"5554321000"}, kTenCentimetres, 60), (Rows{".........."}));
}

TEST(Classify, LooksForASplitStepOnlyWhereTheGroundIsKnown) {
  EXPECT_EQ(classes_of({"2?0"}, kTenCentimetres, 65), (Rows{".?."}));
  EXPECT_EQ(classes_of({"?10"}, kTenCentimetres, 65), (Rows{"?.."}));
}

TEST(Classify, TakesMapsOfOneRowOrColumn) {
  EXPECT_EQ(classes_of({"9"}, kTenCentimetres), (Rows{"."}));
  EXPECT_EQ(classes_of({"9", "0"}, kTenCentimetres), (Rows{"#", "."}));
}

TEST(EmptyGrid, HoldsBothItsEnds) {
  const auto grid = empty_grid({-3, -1}, {2, 0}, 125);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->width, 6);
  EXPECT_EQ(grid->height, 2);
  EXPECT_TRUE(grid->contains({-3, -1}));
  EXPECT_TRUE(grid->contains({2, 0}));
  EXPECT_FALSE(grid->contains({3, 0}));
  EXPECT_FALSE(grid->contains({-4, 0}));
  EXPECT_EQ(grid->probability, std::vector<std::uint8_t>(12, 0));
}

TEST(EmptyGrid, RefusesWhatNoMachineCanHold) {
  constexpr auto kLow = std::numeric_limits<std::int32_t>::min();
  constexpr auto kHigh = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(empty_grid({kLow, kLow}, {kHigh, kHigh}, 125).error().code, ErrorCode::exhausted);
  EXPECT_EQ(empty_grid({0, 0}, {1 << 27, 0}, 125).error().code, ErrorCode::exhausted);
  EXPECT_EQ(empty_grid({1, 0}, {0, 0}, 125).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(empty_grid({0, 0}, {0, 0}, 0).error().code, ErrorCode::invalid_argument);
}

TEST(HeightGrid, ContainsNothingFarAwayWhereverItLies) {
  HeightGrid grid;
  grid.origin = {std::numeric_limits<std::int32_t>::min(), 0};
  grid.width = grid.height = 4;
  EXPECT_FALSE(grid.contains({std::numeric_limits<std::int32_t>::max(), 0}));
}

TEST(DrawTile, CopiesTheOverlapAndHidesDoubtfulCells) {
  Tile tile(1000);
  tile.set(Tile::index(63, 63), {1111, 200});
  tile.set(Tile::index(62, 63), {1222, 30});
  tile.set(Tile::index(0, 0), {1333, 200});
  auto grid = empty_grid({-3, -2}, {1, 1}, 125).value();
  draw_tile(grid, {0, -1, -1}, tile, 100);
  EXPECT_EQ(grid.height_mm[grid.at({-1, -1})], 1111);
  EXPECT_EQ(grid.probability[grid.at({-1, -1})], 200);
  EXPECT_EQ(grid.probability[grid.at({-2, -1})], 0);
  EXPECT_EQ(std::count(grid.probability.begin(), grid.probability.end(), 0), 19);
}

TEST(DrawTile, LeavesAGridAloneThatItDoesNotMeet) {
  Tile tile(0);
  tile.set(0, {5, 200});
  auto grid = empty_grid({0, 0}, {3, 3}, 125).value();
  draw_tile(grid, {0, 1, 0}, tile, 1);
  draw_tile(grid, {0, std::numeric_limits<std::int32_t>::min(), 0}, tile, 1);
  EXPECT_EQ(grid.probability, std::vector<std::uint8_t>(16, 0));
}

}  // namespace
}  // namespace cairn
