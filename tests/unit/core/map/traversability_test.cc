#include "core/map/traversability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <random>

#include "core/map/soft_ground.h"
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

/// Cell by cell, as the rule says it.
class ByTheRule {
 public:
  ByTheRule(const HeightGrid& grid, std::int64_t limit_mm) : grid_(grid), limit_mm_(limit_mm) {}

  std::vector<CellClass> classes() {
    for (std::size_t i = 0; i < grid_.probability.size(); ++i) {
      classes_.push_back(grid_.probability[i] == 0 ? CellClass::unknown : CellClass::free);
    }
    for (int y = 0; y < grid_.height; ++y) {
      for (int x = 0; x < grid_.width; ++x) {
        for (int way = 0; way < 9; ++way) {
          if (way != 4) judge(x, y, way % 3 - 1, way / 3 - 1);
        }
      }
    }
    return classes_;
  }

 private:
  void judge(int x, int y, int dx, int dy) {
    const auto at = [&](int steps) { return height(x + steps * dx, y + steps * dy); };
    const auto top = at(0);
    const auto next = at(1);
    const auto bottom = at(2);
    if (!top || !next) return;
    if (*top - *next > limit_mm_) mark(x, y);
    if (!bottom || *top - *bottom <= limit_mm_) return;
    if (*top - *next > limit_mm_ || *next - *bottom > limit_mm_) return;
    const std::int64_t level = (*top - *bottom) / 4;
    if (at(-1) && *at(-1) - *top >= level) return;
    if (at(3) && *bottom - *at(3) >= level) return;
    mark(x, y);
    if (*next - *bottom > level) mark(x + dx, y + dy);
  }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y * grid_.width + x);
  }
  void mark(int x, int y) { classes_[index(x, y)] = CellClass::obstacle; }
  [[nodiscard]] std::optional<std::int64_t> height(int x, int y) const {
    const bool inside = x >= 0 && y >= 0 && x < grid_.width && y < grid_.height;
    if (!inside || grid_.probability[index(x, y)] == 0) return std::nullopt;
    return grid_.height_mm[index(x, y)];
  }

  const HeightGrid& grid_;
  std::int64_t limit_mm_;
  std::vector<CellClass> classes_;
};

/// Levels at some steps' height from each other, a ragged edge between them, some of it unknown.
HeightGrid ragged_steps(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](unsigned limit) { return static_cast<int>(random() % limit); };
  HeightGrid grid = empty_grid({0, 0}, {below(120), below(60)}, 125).value();
  const int step_mm = 20 + below(300);
  const int unknown_of_hundred = below(20);
  const int cliffs_of_thousand = below(8);
  const std::int32_t ends[] = {-32768, 32767, -16000, 16383, 100'000'000, -100'000'000};
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const std::size_t at = grid.at({x, y});
      const int level = (x + y / 2 + below(3)) / 5 % 4;
      grid.height_mm[at] = level * step_mm + below(30);
      if (below(1000) < cliffs_of_thousand) grid.height_mm[at] = ends[below(6)];
      grid.probability[at] = below(100) < unknown_of_hundred ? 0 : 200;
    }
  }
  return grid;
}

TEST(Classify, DoesByRowsWhatTheRuleSaysOfEachCell) {
  std::size_t split = 0;
  for (unsigned seed = 0; seed < 500; ++seed) {
    const HeightGrid grid = ragged_steps(seed);
    const std::int32_t limit_mm = seed % 17 == 0   ? 16383
                                  : seed % 19 == 0 ? 50'000
                                                   : static_cast<std::int32_t>(seed % 200);
    const auto expected = ByTheRule(grid, limit_mm).classes();
    for (const TerrainKernels* kernels : usable_terrain_kernels()) {
      std::vector<CellClass> classes;
      SoftGround ground;
      judge(grid, {limit_mm, 0, 0.0}, {}, classes, ground, *kernels);
      ASSERT_EQ(classes, expected) << kernels->name << " seed " << seed;
    }
    split += static_cast<std::size_t>(std::ranges::count(expected, CellClass::obstacle));
  }
  EXPECT_GT(split, 100'000U);
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
