#include <gtest/gtest.h>

#include <limits>

#include "core/planner/plan.h"
#include "tests/support/ascii_grid.h"

namespace cairn {
namespace {

using test::draw;
using Cells = std::vector<CellIndex>;

DrivableGrid drivable(const std::vector<std::string>& rows, VehicleLimits limits = {100, 100, 0}) {
  PlannerConfig config;
  config.limits = limits;
  return make_drivable(draw(rows).grid, config);
}

Eigen::Vector2d middle(int x, int y) { return {(x + 0.5) * 0.125, (y + 0.5) * 0.125}; }

TEST(LineIsOpen, WhenEveryCellItTouchesIs) {
  const DrivableGrid grid = drivable({"...#",  //
                                      "....",  //
                                      "...."});
  EXPECT_TRUE(line_is_open(grid, middle(0, 0), middle(3, 1)));
  EXPECT_FALSE(line_is_open(grid, middle(0, 2), middle(3, 2)));
  EXPECT_FALSE(line_is_open(grid, middle(0, 0), middle(3, 2)));
}

TEST(LineIsOpen, NotWhenItTouchesACorner) {
  const DrivableGrid grid = drivable({"#.",  //
                                      ".."});
  EXPECT_FALSE(line_is_open(grid, middle(0, 0), middle(1, 1)));
  EXPECT_FALSE(line_is_open(grid, middle(1, 1), middle(0, 0)));
}

TEST(LineIsOpen, NotAlongTheBorderOfAClosedCell) {
  const DrivableGrid grid = drivable({".#.",  //
                                      "..."});
  EXPECT_FALSE(line_is_open(grid, {0.01, 0.125}, {0.37, 0.125}));
  EXPECT_TRUE(line_is_open(grid, {0.01, 0.12}, {0.37, 0.12}));
  EXPECT_FALSE(line_is_open(grid, {0.125, 0.01}, {0.125, 0.24})) << "upright, on the border";
  EXPECT_TRUE(line_is_open(grid, {0.12, 0.01}, {0.12, 0.24}));
}

TEST(LineIsOpen, NotOutsideTheMapOrWithoutNumbers) {
  const DrivableGrid grid = drivable({"..."});
  EXPECT_FALSE(line_is_open(grid, middle(0, 0), middle(3, 0)));
  EXPECT_FALSE(line_is_open(grid, middle(0, 0), {1e300, 0}));
  EXPECT_FALSE(line_is_open(grid, middle(0, 0), {std::numeric_limits<double>::quiet_NaN(), 0}));
}

TEST(Simplify, KeepsOnlyTheEndsOfAStraightWay) {
  const DrivableGrid grid = drivable({std::string(3000, '.')});
  Cells cells;
  for (int x = 0; x < 3000; ++x) cells.push_back({x, 0});
  const auto points = simplify(grid, cells, 0.06);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points.front(), middle(0, 0));
  EXPECT_EQ(points.back(), middle(2999, 0));
}

TEST(Simplify, KeepsCornersBeyondTheTolerance) {
  const DrivableGrid grid = drivable({"...", "...", "..."});
  const Cells corner = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}};
  EXPECT_EQ(simplify(grid, corner, 0.06).size(), 3U);
  EXPECT_EQ(simplify(grid, corner, 1.0).size(), 2U);
}

TEST(Simplify, NeverShortensThroughAClosedCell) {
  const DrivableGrid grid = drivable({"...", ".#.", "..."});
  const Cells around = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}};
  EXPECT_EQ(simplify(grid, around, 1.0).size(), 3U);
}

TEST(Simplify, NeverShortensUpAStepThatIsTooHigh) {
  const VehicleLimits one_way{50, 200, 0.0};
  const DrivableGrid grid = drivable({"..1..",  //
                                      "....."},
                                     one_way);
  const Cells around = {{0, 1}, {1, 0}, {2, 0}, {3, 0}, {4, 1}};
  EXPECT_EQ(simplify(grid, around, 1.0).size(), 4U);
  const DrivableGrid downhill = drivable({"221..",  //
                                          "....."},
                                         one_way);
  EXPECT_EQ(simplify(downhill, around, 1.0).size(), 2U);
}

TEST(Simplify, TakesTheShortestPathsAsTheyAre) {
  const DrivableGrid grid = drivable({".."});
  EXPECT_TRUE(simplify(grid, Cells{}, 0.06).empty());
  EXPECT_EQ(simplify(grid, Cells{{0, 0}}, 0.06).size(), 1U);
  EXPECT_EQ(simplify(grid, Cells{{0, 0}, {1, 0}}, 0.06).size(), 2U);
}

}  // namespace
}  // namespace cairn
