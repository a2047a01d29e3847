#include "core/planner/trulla.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/planner/field_walk.h"
#include "tests/support/ascii_grid.h"
#include "tests/support/plain_field.h"

namespace cairn {
namespace {

using test::AsciiGrid;
using test::draw;
using Rows = std::vector<std::string>;

PlannerConfig point_robot() {
  PlannerConfig config;
  config.limits = {100, 100, 0.0};
  return config;
}

/// The step that each cell takes first, 'G' at the goal and ' ' where there is no way.
Rows arrows(const DrivableGrid& grid, const Field& field) {
  Rows rows;
  for (int y = field.height - 1; y >= 0; --y) {
    std::string row;
    for (int x = 0; x < field.width; ++x) {
      if (CellIndex{x, y} == field.goal || cost_to_goal(grid, field, {x, y}) == kNoWay) {
        row += CellIndex{x, y} == field.goal ? 'G' : ' ';
        continue;
      }
      const CellIndex next = cells_down(grid, field, {x, y})[1];
      for (int d = 0; d < 8; ++d) {
        if (CellIndex{x + kStepX[d], y + kStepY[d]} == next) row += std::to_string(d);
      }
    }
    rows.push_back(row);
  }
  return rows;
}

Rows arrows_to_goal(const Rows& rows, const PlannerConfig& config) {
  const AsciiGrid drawn = draw(rows);
  const DrivableGrid grid = make_drivable(drawn.grid, config);
  const auto field = compute_field(grid, drawn.cell('G'));
  EXPECT_TRUE(field);
  return arrows(grid, *field);
}

TEST(Trulla, PointsEveryCellTowardsTheGoal) {
  EXPECT_EQ(arrows_to_goal({"...",  //
                            ".G.",  //
                            "..."},
                           point_robot()),
            (Rows{"765",  //
                  "0G4",  //
                  "123"}));
}

TEST(Trulla, LeadsAroundAWallWithoutCuttingItsCorners) {
  EXPECT_EQ(arrows_to_goal({".....",  //
                            ".###.",  //
                            "...#G"},
                           point_robot()),
            (Rows{"00006",  //
                  "2   6",  //
                  "244 G"}));
}

TEST(Trulla, ReachesNothingBehindAClosedWall) {
  EXPECT_EQ(arrows_to_goal({".#..",  //
                            ".#..",  //
                            ".#.G"},
                           point_robot()),
            (Rows{"  66",  //
                  "  76",  //
                  "  0G"}));
}

TEST(Trulla, TakesAOneWayStepInItsDirectionOnly) {
  PlannerConfig config = point_robot();
  config.limits = {50, 200, 0.0};
  EXPECT_EQ(arrows_to_goal({"222G00"}, config), (Rows{"000G44"}));
  EXPECT_EQ(arrows_to_goal({"222200G"}, config), (Rows{"000000G"}));
  const AsciiGrid drawn = draw({"222000"});
  const DrivableGrid grid = make_drivable(drawn.grid, config);
  EXPECT_EQ(arrows(grid, *compute_field(grid, {5, 0})), (Rows{"00000G"}));
  EXPECT_EQ(arrows(grid, *compute_field(grid, {0, 0})), (Rows{"G44   "}));
}

TEST(Trulla, GoesAroundAHillWhenClimbingIsDearer) {
  const Rows hill = {".......",  //
                     "...1...",  //
                     "..121.G",  //
                     "...1...",  //
                     "......."};
  PlannerConfig config = point_robot();
  const AsciiGrid drawn = draw(hill);
  const DrivableGrid grid = make_drivable(drawn.grid, config);
  const Field around = *compute_field(grid, drawn.cell('G'));
  for (const CellIndex cell : cells_down(grid, around, {0, 2})) {
    EXPECT_EQ(grid.heights.height_mm[grid.heights.at(cell)], 0);
  }
  config.climb_effort = config.descend_effort = 0;
  const DrivableGrid easy = make_drivable(drawn.grid, config);
  const Field over = *compute_field(easy, drawn.cell('G'));
  EXPECT_EQ(cells_down(easy, over, {0, 2}).size(), 7U);
}

TEST(Trulla, ClimbingAndDescendingCostWhatTheyAreWorth) {
  PlannerConfig config = point_robot();
  config.climb_effort = 8;
  config.descend_effort = 2;
  const DrivableGrid grid = make_drivable(draw({"0011122"}).grid, config);
  const double up_m = 6 * 0.125 + 0.2 * 8;
  const double down_m = 6 * 0.125 + 0.2 * 2;
  const Field up = *compute_field(grid, {6, 0});
  const Field down = *compute_field(grid, {0, 0});
  EXPECT_NEAR(cost_to_goal(grid, up, {0, 0}) * grid.unit_m(), up_m, 1e-3);
  EXPECT_NEAR(cost_to_goal(grid, down, {6, 0}) * grid.unit_m(), down_m, 1e-3);
  EXPECT_EQ(cost_to_goal(grid, up, {6, 0}), 0U);
}

TEST(Trulla, KnowsDirectionsBetweenTheEight) {
  HeightGrid flat = empty_grid({0, 0}, {400, 400}, 125).value();
  std::fill(flat.probability.begin(), flat.probability.end(), std::uint8_t{200});
  const DrivableGrid grid = make_drivable(std::move(flat), point_robot());
  const Field field = *compute_field(grid, {0, 0});
  for (int y = 0; y <= 400; y += 25) {
    const double straight = std::hypot(400, y) * kCellUnits;
    EXPECT_NEAR(cost_to_goal(grid, field, {400, y}) / straight, 1.0, 0.006) << y;
  }
}

TEST(Trulla, CrossesUnknownGroundOnlyWhenThatIsCheaper) {
  const Rows gap = {"...?...",  //
                    ".##?##.",  //
                    "...?..G"};
  PlannerConfig config = point_robot();
  const AsciiGrid drawn = draw(gap);
  const auto cost = [&] {
    const DrivableGrid grid = make_drivable(drawn.grid, config);
    return cost_to_goal(grid, *compute_field(grid, drawn.cell('G')), {0, 0});
  };
  EXPECT_EQ(cost(), kNoWay);
  config.unknown = UnknownGround::allowed;
  EXPECT_EQ(cost(), (6U + 2U) * kCellUnits);
}

TEST(Trulla, SolvesAMazeAsThePlainMethodDoes) {
  const AsciiGrid drawn = draw({"#####################",  //
                                "#S..#.....#.....#...#",  //
                                "###.#.###.#.###.#.#.#",  //
                                "#...#.#...#.#...#.#.#",  //
                                "#.###.#.###.#.###.#.#",  //
                                "#.....#.....#.....#G#",  //
                                "#####################"});
  const PlannerConfig config = point_robot();
  const DrivableGrid grid = make_drivable(drawn.grid, config);
  const auto field = compute_field(grid, drawn.cell('G'));
  ASSERT_TRUE(field);
  EXPECT_EQ(test::costs(grid, *field), test::plain_field(grid, drawn.cell('G')));
  EXPECT_EQ(cells_down(grid, *field, drawn.cell('S')).back(), drawn.cell('G'));
}

TEST(Trulla, SaysWhyAGoalIsRefused) {
  const AsciiGrid drawn = draw({"...?.#"});
  const PlannerConfig config = point_robot();
  const DrivableGrid grid = make_drivable(drawn.grid, config);
  const auto why = [&](CellIndex goal) { return compute_field(grid, goal).error(); };
  EXPECT_EQ(why({9, 0}).message, "the goal lies outside the map");
  EXPECT_EQ(why({5, 0}).message, "the goal is on an obstacle");
  EXPECT_EQ(why({3, 0}).code, ErrorCode::invalid_argument);
}

TEST(Trulla, StaysExactWhenSingleStepsOutreachTheQueue) {
  // Steps of up to 9 · 30 m at 100 m/m against 0.125 m on the level: a ratio of 200,000.
  const Rows towers = {"0909090", "0000909", "9090000", "0990909", "0000000"};
  PlannerConfig config = point_robot();
  config.limits = {1'000'000, 1'000'000, 0.0};
  config.climb_effort = 100;
  config.descend_effort = 37.5;
  const AsciiGrid drawn = draw(towers, 30'000);
  const DrivableGrid grid = make_drivable(drawn.grid, config);
  for (const CellIndex goal : {CellIndex{0, 0}, CellIndex{1, 4}, CellIndex{6, 2}}) {
    EXPECT_EQ(test::costs(grid, *compute_field(grid, goal)), test::plain_field(grid, goal));
  }
}

TEST(Trulla, CountsWaysThatDoNotFitAsNotReachable) {
  PlannerConfig config = point_robot();
  config.limits = {100'000'000, 100'000'000, 0.0};
  config.descend_effort = config.climb_effort = 100;
  const AsciiGrid drawn = draw(Rows{"0" +
                                    [] {
                                      std::string zigzag;
                                      for (int i = 0; i < 20; ++i) zigzag += "90";
                                      return zigzag;
                                    }()},
                               10'000);
  const DrivableGrid grid = make_drivable(drawn.grid, config);
  const Field field = *compute_field(grid, {40, 0});
  const std::uint32_t two = cost_to_goal(grid, field, {38, 0});
  EXPECT_NEAR(two * grid.unit_m(), 2 * (0.125 + 90 * 100), 1.0);
  EXPECT_LT(cost_to_goal(grid, field, {26, 0}), kNoWay);
  EXPECT_EQ(cost_to_goal(grid, field, {10, 0}), kNoWay);
}

TEST(Trulla, FillsFourMillionOpenCellsInSeconds) {
  const PlannerConfig config = point_robot();
  HeightGrid flat = empty_grid({0, 0}, {1999, 1999}, 125).value();
  std::fill(flat.probability.begin(), flat.probability.end(), std::uint8_t{200});
  const auto begin = std::chrono::steady_clock::now();
  const DrivableGrid grid = make_drivable(std::move(flat), config);
  const auto field = compute_field(grid, {0, 0});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(cost_to_goal(grid, *field, {1999, 1999}), 1999U * 1393U);
  // 0.4 s alone and optimised; room for sanitizers on a busy machine, none for a slower order.
  EXPECT_LT(taken.count(), 20.0);
  RecordProperty("seconds", std::to_string(taken.count()));
}

}  // namespace
}  // namespace cairn
