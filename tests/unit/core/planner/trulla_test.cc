#include "core/planner/trulla.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "core/planner/plan.h"
#include "tests/support/ascii_grid.h"
#include "tests/support/plain_dijkstra.h"

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

/// The field drawn with its directions, 'G' at the goal and ' ' where there is no way.
Rows arrows(const Field& field) {
  Rows rows;
  for (int y = field.height - 1; y >= 0; --y) {
    std::string row;
    for (int x = 0; x < field.width; ++x) {
      const std::uint8_t d = field.direction[static_cast<std::size_t>(y * field.width + x)];
      row += d == Field::kNoDirection ? ' ' : "01234567G"[d];
    }
    rows.push_back(row);
  }
  return rows;
}

Rows arrows_to_goal(const Rows& rows, const PlannerConfig& config) {
  const AsciiGrid drawn = draw(rows);
  const auto field = compute_field(make_drivable(drawn.grid, config), drawn.cell('G'), config);
  EXPECT_TRUE(field);
  return arrows(*field);
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
  EXPECT_EQ(arrows(*compute_field(grid, {5, 0}, config)), (Rows{"00000G"}));
  EXPECT_EQ(arrows(*compute_field(grid, {0, 0}, config)), (Rows{"G44   "}));
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
  const auto around = follow(*compute_field(grid, drawn.cell('G'), config), {0, 2});
  for (const CellIndex cell : around) EXPECT_EQ(grid.heights.height_mm[grid.heights.at(cell)], 0);
  config.climb_effort = config.descend_effort = 0;
  const auto over = follow(*compute_field(grid, drawn.cell('G'), config), {0, 2});
  EXPECT_EQ(over.size(), 7U);
}

TEST(Trulla, CrossesUnknownGroundOnlyWhenThatIsCheaper) {
  const Rows gap = {"...?...",  //
                    ".##?##.",  //
                    "...?..G"};
  PlannerConfig config = point_robot();
  const AsciiGrid drawn = draw(gap);
  EXPECT_EQ(compute_field(make_drivable(drawn.grid, config), drawn.cell('G'), config)->cost[0],
            kNoWay);
  config.unknown = UnknownGround::allowed;
  EXPECT_EQ(compute_field(make_drivable(drawn.grid, config), drawn.cell('G'), config)->cost[0],
            6U * 1250U + 2U * 1250U);
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
  const auto field = compute_field(grid, drawn.cell('G'), config);
  ASSERT_TRUE(field);
  EXPECT_EQ(field->cost, test::plain_dijkstra(grid, drawn.cell('G'), config));
  EXPECT_EQ(follow(*field, drawn.cell('S')).back(), drawn.cell('G'));
}

TEST(Trulla, SaysWhyAGoalIsRefused) {
  const AsciiGrid drawn = draw({"...?.#"});
  const PlannerConfig config = point_robot();
  const DrivableGrid grid = make_drivable(drawn.grid, config);
  const auto why = [&](CellIndex goal) { return compute_field(grid, goal, config).error(); };
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
    EXPECT_EQ(compute_field(grid, goal, config)->cost, test::plain_dijkstra(grid, goal, config));
  }
}

TEST(Trulla, CountsWaysThatDoNotFitAsNotReachable) {
  PlannerConfig config = point_robot();
  config.limits = {100'000'000, 100'000'000, 0.0};
  config.descend_effort = 100;
  DrivableGrid grid = make_drivable(draw({"....."}).grid, config);
  grid.heights.height_mm = {8'000'000, 6'000'000, 4'000'000, 2'000'000, 0};
  const auto field = compute_field(grid, {4, 0}, config);
  EXPECT_EQ(field->cost[2], 2U * (1250U + 2'000'000'000U));
  EXPECT_EQ(field->cost[1], kNoWay);
  EXPECT_EQ(field->direction[1], Field::kNoDirection);
}

TEST(Trulla, FillsFourMillionOpenCellsInSeconds) {
  const PlannerConfig config = point_robot();
  HeightGrid flat = empty_grid({0, 0}, {1999, 1999}, 125).value();
  std::fill(flat.probability.begin(), flat.probability.end(), std::uint8_t{200});
  const auto begin = std::chrono::steady_clock::now();
  const DrivableGrid grid = make_drivable(std::move(flat), config);
  const auto field = compute_field(grid, {0, 0}, config);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(field->cost.back(), 1999U * 1768U);
  // 0.4 s alone and optimised; room for sanitizers on a busy machine, none for a slower order.
  EXPECT_LT(taken.count(), 20.0);
  RecordProperty("seconds", std::to_string(taken.count()));
}

}  // namespace
}  // namespace cairn
