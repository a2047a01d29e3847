// What the driver makes of the ground ahead.

#include "tests/unit/robot_agent/drive/driver_fixture.h"

namespace cairn::agent {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(DriverTest, StopsShortOfAWallThatThePathDidNotKnow) {
  wall_at(2.0);
  take(go_to(7, {{0, 0}, {5, 0}}));
  run(seconds(20));
  EXPECT_LT(pose.x_m, 2.0 - DriverConfig{}.limits.radius_m);
  EXPECT_GT(pose.x_m, 0.5);
  EXPECT_EQ(wheels.speed_m_s, 0.0);
  EXPECT_EQ(driver.state(), DriveState::blocked);
}

TEST_F(DriverTest, ReportsAClosedWayOnceAndThenEveryThreeSeconds) {
  wall_at(1.0);
  take(go_to(7, {{0, 0}, {5, 0}}));
  run(seconds(1));
  ASSERT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::blocked));
  EXPECT_THAT(reports.back().why, HasSubstr("closes the way"));
  run(milliseconds(2'000));
  EXPECT_EQ(reports.size(), 2U);
  run(milliseconds(7'000));
  EXPECT_EQ(reports.size(), 5U);
}

TEST_F(DriverTest, SaysNothingOfAWayThatIsClosedForAMoment) {
  wall_at(1.0);
  take(go_to(7, {{0, 0}, {3, 0}}));
  run(milliseconds(300));
  cells = [](CellIndex) { return Cell{0, 200}; };
  run(seconds(20));
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::arrived));
}

TEST_F(DriverTest, DrivesOnAlongANewPathAfterItWasBlocked) {
  wall_at(2.0);
  take(go_to(7, {{0, 0}, {4, 0}}));
  run(seconds(10));
  ASSERT_EQ(driver.state(), DriveState::blocked);
  box_at(2.0);
  take(go_to(7, {testing::place_of(pose), {0.6, 2}, {4, 2}, {4, 0}}, 2));
  run(seconds(60));
  EXPECT_EQ(reports.back().state, CommandState::arrived);
}

TEST_F(DriverTest, GoesAroundABoxThatThePathDidNotKnow) {
  box_at(2.0);
  take(go_to(7, {{0, 0}, {6, 0}}));
  for (const MonotonicTime end = clock + seconds(60); clock < end;) {
    step();
    const Eigen::Vector2d place_m = testing::place_of(pose);
    const Eigen::Vector2d nearest_m =
        place_m.cwiseMax(Eigen::Vector2d(2.0, -0.5)).cwiseMin(Eigen::Vector2d(2.5, 0.5));
    ASSERT_GT((place_m - nearest_m).norm(), 0.35);
  }
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::arrived));
}

TEST_F(DriverTest, GoesAroundOnGroundItHasSeenOnly) {
  cells = [](CellIndex cell) {
    const bool wall = cell.x == 16;
    const bool seen = std::abs(cell.y) < 12;
    return wall && seen ? Cell{1000, 200} : seen ? Cell{0, 200} : Cell{};
  };
  take(go_to(7, {{0, 0}, {4, 0}}));
  run(seconds(20));
  EXPECT_EQ(driver.state(), DriveState::blocked);
  EXPECT_THAT(reports.back().why, HasSubstr("closes the way"));
}

/// 2 m ahead, open 12 m to the left: further than the robot looks around itself at first.
Cell long_wall(CellIndex cell) {
  return {cell.x >= 16 && cell.x < 18 && cell.y < 96 ? 1000 : 0, 200};
}

TEST_F(DriverTest, LeavesALongWayAroundToTheServer) {
  cells = long_wall;
  take(go_to(7, {{0, 0}, {4, 0}}));
  run(seconds(10));
  EXPECT_EQ(reports.back().state, CommandState::blocked);
}

TEST_F(DriverTest, FindsALongWayAroundByItselfWhenTheServerIsAway) {
  cells = long_wall;
  proto::RobotLink::Order order = go_to(7, {{0, 0}, {4, 0}});
  order.command.on_link_loss = OnLinkLoss::proceed;
  take(order);
  silence = seconds(60);
  run(seconds(120));
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::arrived));
}

TEST_F(DriverTest, StopsWhereTheGroundIsTooSteep) {
  take(go_to(7, {{0, 0}, {5, 0}}));
  pose.roll_rad = -0.5;
  step();
  EXPECT_EQ(wheels.speed_m_s, 0.0);
  EXPECT_EQ(reports.back().state, CommandState::stopped);
  EXPECT_THAT(reports.back().why, HasSubstr("too steep"));
}

TEST_F(DriverTest, DoesNotDriveToAPathThatBeginsFarAway) {
  take(go_to(7, {{5, 5}, {8, 5}}));
  run(seconds(2));
  EXPECT_EQ(testing::place_of(pose), Eigen::Vector2d(0, 0));
  EXPECT_EQ(reports.back().state, CommandState::blocked);
  EXPECT_THAT(reports.back().why, HasSubstr("7.1 m away"));
}

TEST_F(DriverTest, AsksForTheRestOfAPathThatWasCutToTheWiresBound) {
  proto::RobotLink::Order order = go_to(7, {{0, 0}, {1, 0}});
  order.command.path_cut = true;
  take(order);
  run(seconds(20));
  EXPECT_EQ(reports.back().state, CommandState::blocked);
  EXPECT_THAT(reports.back().why, HasSubstr("the rest"));
}

TEST_F(DriverTest, SlowsDownWhereSomeGroundIsUnseen) {
  cells = [](CellIndex cell) { return cell.x == 6 ? Cell{} : Cell{0, 200}; };
  take(go_to(7, {{0, 0}, {5, 0}}));
  step();
  EXPECT_GT(wheels.speed_m_s, 0.0);
  EXPECT_LE(wheels.speed_m_s, DriverConfig{}.unknown_speed_m_s);
}

TEST_F(DriverTest, NeverDrivesIntoAWideUnseenStretch) {
  cells = [](CellIndex cell) { return cell.x * kCellM >= 2.0 ? Cell{} : Cell{0, 200}; };
  take(go_to(7, {{0, 0}, {5, 0}}));
  double furthest_m = 0.0;
  for (int i = 0; i < 2'000; ++i) {
    step();
    furthest_m = std::max(furthest_m, pose.x_m);
  }
  EXPECT_LT(furthest_m, 2.0);
  EXPECT_EQ(driver.state(), DriveState::blocked);
  EXPECT_THAT(reports.back().why, HasSubstr("may be a drop"));
}

/// Unseen from 2 m to 2.9 m until the wheels get there; behind it the ground lies `drop_m` lower.
struct UnseenStretch : DriverTest {
  double furthest_m = 0.0;
  void drive(double drop_m) {
    cells = [this, drop_m](CellIndex cell) {
      const double x_m = cell.x * kCellM;
      furthest_m = std::max(furthest_m, pose.x_m);
      if (x_m >= 2.0 && x_m < 2.9 && x_m > furthest_m + 0.3) return Cell{};
      return Cell{x_m < 2.9 ? 0 : static_cast<std::int32_t>(-1000.0 * drop_m), 200};
    };
    take(go_to(7, {{0, 0}, {5, 0}}));
    run(seconds(120));
  }
};

TEST_F(UnseenStretch, IsCrossedWhereTheGroundIsAsHighOnBothSides) {
  drive(0.0);
  EXPECT_EQ(reports.back().state, CommandState::arrived);
}

TEST_F(UnseenStretch, IsNotCrossedWhereTheFarSideLiesLower) {
  drive(0.5);
  EXPECT_EQ(driver.state(), DriveState::blocked);
  EXPECT_LT(furthest_m, 2.0);
}

TEST_F(DriverTest, BacksUpToSeeTheGroundAheadBetter) {
  cells = [](CellIndex cell) { return cell.x * kCellM >= 0.375 ? Cell{} : Cell{0, 200}; };
  take(go_to(7, {{0, 0}, {5, 0}}));
  step();
  EXPECT_LT(wheels.speed_m_s, 0.0);
}

TEST_F(DriverTest, DoesNotBackUpOntoUnseenGround) {
  cells = [](CellIndex cell) { return std::abs(cell.x) >= 3 ? Cell{} : Cell{0, 200}; };
  take(go_to(7, {{0, 0}, {5, 0}}));
  run(seconds(2));
  EXPECT_EQ(testing::place_of(pose), Eigen::Vector2d(0, 0));
  EXPECT_EQ(driver.state(), DriveState::blocked);
}

}  // namespace
}  // namespace cairn::agent
