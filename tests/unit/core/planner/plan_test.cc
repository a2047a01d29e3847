#include "core/planner/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/ascii_grid.h"

namespace cairn {
namespace {

using test::AsciiGrid;
using test::draw;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Rows = std::vector<std::string>;

Eigen::Vector2d middle(CellIndex cell) { return {(cell.x + 0.5) * 0.125, (cell.y + 0.5) * 0.125}; }

PlannerConfig with_radius(double radius_m) {
  PlannerConfig config;
  config.limits.radius_m = radius_m;
  return config;
}

/// Plans from the middle of 'S' to the middle of 'G'.
Path planned(const Rows& rows, const PlannerConfig& config, bool allow_partial = false) {
  const AsciiGrid drawn = draw(rows);
  return plan(make_drivable(drawn.grid, config),
              {middle(drawn.cell('S')), middle(drawn.cell('G')), allow_partial}, config);
}

TEST(Plan, LeadsFromTheTrueStartToTheExactGoal) {
  const PlannerConfig config = with_radius(0.0);
  const DrivableGrid grid = make_drivable(draw({".....", ".....", "....."}).grid, config);
  const Path path = plan(grid, {{0.01, 0.02}, {0.6, 0.3}}, config);
  EXPECT_EQ(path.status, PathStatus::complete);
  EXPECT_EQ(path.why, "");
  EXPECT_EQ(path.points_m.front(), Eigen::Vector2d(0.01, 0.02));
  EXPECT_EQ(path.points_m.back(), Eigen::Vector2d(0.6, 0.3));
  EXPECT_NEAR(path.cost_m, 0.125 * std::hypot(4, 2), 0.02);
  EXPECT_GT(path.length_m, 0.64);
  EXPECT_LT(path.length_m, 0.75);
}

TEST(Plan, WithinOneCellIsAStraightLine) {
  const PlannerConfig config = with_radius(0.0);
  const DrivableGrid grid = make_drivable(draw({"."}).grid, config);
  const Path path = plan(grid, {{0.01, 0.02}, {0.11, 0.02}}, config);
  EXPECT_EQ(path.status, PathStatus::complete);
  EXPECT_EQ(path.points_m.size(), 2U);
  EXPECT_NEAR(path.length_m, 0.1, 1e-12);
}

TEST(Plan, GoesAroundAWallAtTheVehiclesRadius) {
  const Path path = planned({"...........",  //
                             "...........",  //
                             ".S...#...G.",  //
                             ".....#.....",  //
                             ".....#....."},
                            with_radius(0.2));
  EXPECT_EQ(path.status, PathStatus::complete);
  for (const auto& point : path.points_m) EXPECT_GE((point - middle({5, 2})).norm(), 0.2);
}

TEST(Plan, LeavesATightStartByTheShortestStraightWay) {
  const Path path = planned({"#.......",  //
                             "#S.....G",  //
                             "#......."},
                            with_radius(0.3));
  EXPECT_EQ(path.status, PathStatus::complete);
  EXPECT_EQ(path.points_m.front(), middle({1, 1}));
  EXPECT_NEAR(path.cost_m, 6 * 0.125, 1e-9);
}

TEST(Plan, LeavesAStartOnUnknownGround) {
  const PlannerConfig config = with_radius(0.2);
  const DrivableGrid grid = make_drivable(draw({"?????..G"}).grid, config);
  const Path path = plan(grid, {middle({1, 0}), middle({7, 0})}, config);
  EXPECT_EQ(path.status, PathStatus::complete);
  EXPECT_NEAR(path.cost_m, 6 * 0.125, 1e-9);
}

TEST(Plan, LeavesNoStartThroughAWall) {
  const Path path = planned({"?#....G",  //
                             "S#.....",  //
                             "?#....."},
                            with_radius(0.3));
  EXPECT_EQ(path.status, PathStatus::none);
  EXPECT_EQ(path.why,
            "no open ground straight within 0.85 m of the start, which is 0.12 m from an obstacle, "
            "nearer than the vehicle's radius 0.30 m");
}

TEST(Plan, LeavesAStartByAWayThatLeadsOn) {
  // The nearest open cell, to the west, is a pocket.
  const PlannerConfig config = with_radius(0.1);
  const DrivableGrid grid = make_drivable(draw({"##########",  //
                                                "#.????..G#",  //
                                                "##########"})
                                              .grid,
                                          config);
  const Path path = plan(grid, {middle({3, 1}), middle({8, 1})}, config);
  EXPECT_EQ(path.status, PathStatus::complete);
  EXPECT_NEAR(path.cost_m, 5 * 0.125, 1e-9);
  EXPECT_EQ(plan(grid, {middle({3, 1}), middle({1, 1})}, config).status, PathStatus::complete);
}

TEST(Plan, LeavesNoStartOverAStepBeyondTheLimits) {
  PlannerConfig config = with_radius(0.0);
  config.limits.climb_mm = 50;
  config.limits.descend_mm = 200;
  DrivableGrid grid = make_drivable(draw({"0011"}).grid, config);
  grid.open[0] = grid.open[1] = 0;
  EXPECT_EQ(plan(grid, {middle({1, 0}), middle({3, 0})}, config).status, PathStatus::none);
  grid.open = {1, 1, 0, 0};
  EXPECT_EQ(plan(grid, {middle({2, 0}), middle({0, 0})}, config).status, PathStatus::complete);
}

TEST(Plan, SaysWhyTheGoalIsRefused) {
  const PlannerConfig config = with_radius(0.35);
  EXPECT_EQ(planned({"S......G.#"}, config).why,
            "the goal is 0.25 m from an obstacle, nearer than the vehicle's radius 0.35 m");
  const AsciiGrid drawn = draw({"S.....??.....#"});
  const DrivableGrid grid = make_drivable(drawn.grid, config);
  const auto why = [&](const Eigen::Vector2d& goal) {
    const Path path = plan(grid, {middle({0, 0}), goal}, config);
    EXPECT_EQ(path.status, PathStatus::none);
    EXPECT_TRUE(path.points_m.empty());
    return path.why;
  };
  EXPECT_EQ(why(middle({13, 0})), "the goal is on an obstacle");
  EXPECT_EQ(why({5, 5}), "the goal lies outside the map");
  EXPECT_EQ(why({1e300, 0}), "the goal lies outside the map");
  EXPECT_EQ(why(middle({6, 0})),
            "the goal is on ground nobody has seen: allow unknown ground or pick another");
  EXPECT_EQ(why(middle({8, 0})), "obstacles or steps cut the goal off from here");
  EXPECT_EQ(why({std::numeric_limits<double>::quiet_NaN(), 0}),
            "the goal's coordinates are not numbers");
}

TEST(Plan, SaysWhyTheStartIsRefused) {
  const PlannerConfig config = with_radius(0.0);
  const DrivableGrid grid = make_drivable(draw({"..."}).grid, config);
  EXPECT_EQ(plan(grid, {{-1, 0}, {0, 0}}, config).why, "the start lies outside the map");
  EXPECT_EQ(plan(grid, {{HUGE_VAL, 0}, {0, 0}}, config).why,
            "the start's coordinates are not numbers");
}

TEST(Plan, ComesAsNearAsItCanWhenThatIsAllowed) {
  const Path path = planned({".....#...",  //
                             ".S...#.G.",  //
                             ".....#..."},
                            with_radius(0.0), true);
  EXPECT_EQ(path.status, PathStatus::partial);
  EXPECT_THAT(path.why, StartsWith("obstacles or steps"));
  EXPECT_EQ(path.points_m.front(), middle({1, 1}));
  EXPECT_EQ(path.points_m.back(), middle({4, 1}));
}

TEST(Plan, ComesNearAGoalThatIsClosedOrOutside) {
  const PlannerConfig config = with_radius(0.0);
  const DrivableGrid grid = make_drivable(draw({"...#", "....", "...."}).grid, config);
  const Path onto = plan(grid, {middle({0, 0}), middle({3, 2}), true}, config);
  EXPECT_EQ(onto.status, PathStatus::partial);
  EXPECT_THAT(onto.why, HasSubstr("obstacle"));
  EXPECT_EQ(onto.points_m.back(), middle({3, 1}));
  const Path outside = plan(grid, {middle({0, 0}), {100, 0.0}, true}, config);
  EXPECT_EQ(outside.status, PathStatus::partial);
  EXPECT_EQ(outside.points_m.back(), middle({3, 0}));
}

TEST(Plan, ComesNearOnlyWhereTheVehicleCanDriveItself) {
  // Up on the block one is nearer to the goal, but 0.1 m is too high to climb.
  PlannerConfig config = with_radius(0.0);
  config.limits.climb_mm = 50;
  config.limits.descend_mm = 200;
  const Path path = planned({"S...11#G"}, config, true);
  EXPECT_EQ(path.status, PathStatus::partial);
  EXPECT_EQ(path.points_m.back(), middle({3, 0}));
}

TEST(Plan, DrivesAOneWayStepDownAndNotUp) {
  PlannerConfig config = with_radius(0.0);
  config.limits.climb_mm = 50;
  config.limits.descend_mm = 200;
  const AsciiGrid drawn = draw({"2220000"});
  const DrivableGrid grid = make_drivable(drawn.grid, config);
  EXPECT_EQ(plan(grid, {middle({0, 0}), middle({6, 0})}, config).status, PathStatus::complete);
  EXPECT_EQ(plan(grid, {middle({6, 0}), middle({0, 0})}, config).status, PathStatus::none);
}

TEST(Plan, TellsWhichFrontierWouldOpenAWay) {
  PlannerConfig config = with_radius(0.0);
  config.unknown = UnknownGround::explore;
  const std::vector<std::string> gap = {"...#...",  //
                                        ".S.?.G.",  //
                                        "...#..."};
  const Path none = planned(gap, config);
  EXPECT_EQ(none.status, PathStatus::none);
  EXPECT_THAT(none.why, HasSubstr("exploring from (0.31, 0.19) m on might open a way"));
  ASSERT_TRUE(none.frontier_m);
  EXPECT_EQ(*none.frontier_m, middle({2, 1}));
  const Path there = planned(gap, config, true);
  EXPECT_EQ(there.status, PathStatus::partial);
  EXPECT_EQ(there.points_m.back(), middle({2, 1}));
  EXPECT_EQ(there.frontier_m, middle({2, 1}));
}

TEST(Plan, TellsNoFrontierWhereAWayIsKnownOrNoneCanBe) {
  PlannerConfig config = with_radius(0.0);
  config.unknown = UnknownGround::explore;
  EXPECT_EQ(planned({".S.?.G.", "......."}, config).status, PathStatus::complete);
  EXPECT_FALSE(planned({".S.?.G.", "......."}, config).frontier_m);
  EXPECT_FALSE(planned({".S.#.G."}, config).frontier_m);
  EXPECT_EQ(planned({".S.#.G."}, config).status, PathStatus::none);
}

}  // namespace
}  // namespace cairn
