#include "server/mission/exploring.h"

#include <gtest/gtest.h>

namespace cairn::server {
namespace {

PlannerConfig planner() {
  PlannerConfig config;
  config.limits.radius_m = 0.2;
  return config;
}

/// A floor of 20 × 4 m in cells of 0.25 m, unseen beyond both ends; walls along its sides.
DrivableGrid corridor() {
  HeightGrid grid = empty_grid({0, 0}, {119, 15}, 250).value();
  for (std::int32_t y = 0; y < 16; ++y) {
    for (std::int32_t x = 20; x < 100; ++x) {
      grid.probability[grid.at({x, y})] = 200;
      grid.height_mm[grid.at({x, y})] = y == 0 || y == 15 ? 1000 : 0;
    }
  }
  return make_drivable(std::move(grid), planner());
}

constexpr double kWestEndM = 5.0;
constexpr double kEastEndM = 25.0;

ExploreWish wish_at(double x_m) { return {{x_m, 2.0}, {}, {}, {}}; }

TEST(ChooseFrontier, TakesTheBestOneWithAPathToIt) {
  const auto choice = choose_frontier(corridor(), wish_at(8.0), planner());
  ASSERT_TRUE(choice.frontier);
  EXPECT_NEAR(choice.frontier->place_m.x(), kWestEndM, 0.5);
  EXPECT_EQ(choice.path.status, PathStatus::complete);
  EXPECT_EQ(choice.path.points_m.back(), choice.frontier->place_m);
}

TEST(ChooseFrontier, LeavesAloneWhatIsAvoided) {
  ExploreWish wish = wish_at(8.0);
  for (double y_m = 0.0; y_m <= 4.0; y_m += 0.5) wish.avoided_m.emplace_back(kWestEndM, y_m);
  const auto choice = choose_frontier(corridor(), wish, planner());
  ASSERT_TRUE(choice.frontier);
  EXPECT_NEAR(choice.frontier->place_m.x(), kEastEndM, 0.5);
}

TEST(ChooseFrontier, LeavesToOtherRobotsWhereTheyGo) {
  ExploreWish wish = wish_at(8.0);
  wish.claimed_m = {{kWestEndM, 2.0}};
  const auto choice = choose_frontier(corridor(), wish, planner());
  ASSERT_TRUE(choice.frontier);
  EXPECT_NEAR(choice.frontier->place_m.x(), kEastEndM, 0.5);
  EXPECT_GT(choice.claimed, 0U);
  wish.claimed_m.emplace_back(kEastEndM, 2.0);
  const auto none = choose_frontier(corridor(), wish, planner());
  EXPECT_FALSE(none.frontier);
  EXPECT_GE(none.claimed, 2U);
}

TEST(ChooseFrontier, KeepsToTheArea) {
  ExploreWish wish = wish_at(8.0);
  wish.area = AreaM{20.0, 0.0, 30.0, 4.0};
  const auto choice = choose_frontier(corridor(), wish, planner());
  ASSERT_TRUE(choice.frontier);
  EXPECT_NEAR(choice.frontier->place_m.x(), kEastEndM, 0.5);
  wish.area = AreaM{10.0, 0.0, 15.0, 4.0};
  EXPECT_FALSE(choose_frontier(corridor(), wish, planner()).frontier);
}

TEST(StillAFrontier, AsLongAsUnseenGroundIsNearThePlace) {
  const DrivableGrid grid = corridor();
  EXPECT_TRUE(still_a_frontier(grid, wish_at(15.0), {kEastEndM - 0.2, 2.0}));
  EXPECT_FALSE(still_a_frontier(grid, wish_at(15.0), {15.0, 2.0}));
}

TEST(EndExploring, IsDoneWhenNothingIsLeft) {
  ExploreWish wish = wish_at(8.0);
  wish.area = AreaM{10.0, 0.0, 20.0, 4.0};
  const auto choice = choose_frontier(corridor(), wish, planner());
  ASSERT_FALSE(choice.frontier);
  Task task;
  end_exploring(task, choice);
  EXPECT_EQ(task.state, TaskState::done);
}

TEST(EndExploring, FailsWhenTheRobotIsShutInAndSaysWhy) {
  DrivableGrid grid = corridor();
  HeightGrid heights = grid.heights;
  for (const std::int32_t x : {45, 46, 54, 55}) {  // Two walls across, the robot between them.
    for (std::int32_t y = 0; y < 16; ++y) heights.height_mm[heights.at({x, y})] = 1000;
  }
  PlannerConfig wide = planner();
  wide.limits.radius_m = 2.0;
  const auto choice = choose_frontier(make_drivable(std::move(heights), wide), wish_at(12.5), wide);
  Task task;
  end_exploring(task, choice);
  EXPECT_EQ(task.state, TaskState::failed);
  EXPECT_NE(task.why.find("cannot leave where it stands"), std::string::npos) << task.why;
}

}  // namespace
}  // namespace cairn::server
