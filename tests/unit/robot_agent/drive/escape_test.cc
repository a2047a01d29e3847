#include "robot_agent/drive/escape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/robot_agent/drive/driver_fixture.h"

namespace cairn::agent {
namespace {

Track track_around_a_bend() {
  Track track;
  for (double x_m = 0.0; x_m < 3.0; x_m += 0.1) track.add({x_m, 0.0});
  for (double y_m = 0.0; y_m <= 1.0; y_m += 0.1) track.add({3.0, y_m});
  return track;
}

TEST(Escape, BacksOutAroundTheBendItCame) {
  Pose pose{3.0, 1.0, 0.0, 0.0, 0.0, M_PI / 2.0};
  Escape escape({}, track_around_a_bend(), {3.0, 1.0}, 0.2);
  int steps = 0;
  for (; steps < 1000; ++steps) {
    const auto command = escape.step(pose);
    if (!command) break;
    EXPECT_LE(command->speed_m_s, 0.0);
    EXPECT_GE(command->speed_m_s, -0.2);
    testing::roll(pose, *command);
  }
  EXPECT_LT(steps, 1000);
  // It followed the bend, and went no further than it may.
  EXPECT_NEAR(pose.y_m, 0.0, 0.15);
  EXPECT_NEAR(pose.x_m, 3.0 + 1.0 - Escape::kMostM, 0.3);
  EXPECT_NEAR(pose.yaw_rad, 0.0, 0.3);
}

TEST(Escape, WithoutATrackIsOverAtOnce) {
  EXPECT_FALSE(Escape({}, Track{}, {1.0, 2.0}, 0.2).step({1.0, 2.0}));
}

/// A dead end as wide as the robot, but not as wide as it would have to be to turn there.
class ClosedInTest : public DriverTest {
 protected:
  ClosedInTest() {
    cells = [](CellIndex cell) {
      const bool between = cell.y >= -4 && cell.y < 3;
      const bool dead_end = cell.x >= 24 && (!between || cell.x >= 40);
      return Cell{dead_end ? 1000 : 0, 200};
    };
  }
};

TEST_F(ClosedInTest, TheRobotBacksOutAndTellsTheServer) {
  CellLookup walls = cells;
  cells = [](CellIndex) { return Cell{0, 200}; };
  take(go_to(1, {{0, 0}, {8, 0}}));
  run(seconds(7));  // It is in there before it learns of the walls.
  const double inside_m = pose.x_m;
  ASSERT_GT(inside_m, 3.3);
  ASSERT_LT(inside_m, 4.3);
  cells = walls;
  run(seconds(25));
  EXPECT_LT(pose.x_m, inside_m - 0.4);
  ASSERT_GE(states().size(), 2U);
  EXPECT_EQ(states().back(), CommandState::blocked);
}

TEST_F(ClosedInTest, OneThatHasRoomWaitsWhereItIs) {
  cells = [](CellIndex cell) { return Cell{cell.x >= 16 ? 1000 : 0, 200}; };
  take(go_to(1, {{0, 0}, {8, 0}}));
  double furthest_m = 0.0;
  for (int i = 0; i < 400; ++i) {
    step();
    furthest_m = std::max(furthest_m, pose.x_m);
    EXPECT_GT(pose.x_m, furthest_m - 0.01);
  }
}

}  // namespace
}  // namespace cairn::agent
