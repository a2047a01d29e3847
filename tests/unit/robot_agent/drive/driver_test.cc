#include "robot_agent/drive/driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/robot_agent/drive/rolling_robot.h"

namespace cairn::agent {
namespace {

using proto::CommandKind;
using proto::CommandReport;
using proto::CommandState;
using proto::DriveState;
using proto::OnLinkLoss;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kCellMm = 125;
constexpr double kCellM = 0.125;

proto::RobotLink::Order go_to(std::uint64_t id, std::vector<Eigen::Vector2d> path_m,
                              std::uint32_t revision = 1) {
  proto::RobotLink::Order order;
  order.command.id = id;
  order.command.revision = revision;
  order.command.kind = CommandKind::go_to;
  order.command.issuer = "Ada";
  order.command.expires_clock_ms = 1'000'000;
  order.command.on_link_loss = OnLinkLoss::stop;
  order.command.link_timeout_ms = 5'000;
  for (const Eigen::Vector2d& p : path_m) {
    order.path.push_back({static_cast<std::int32_t>(std::lround(p.x() * 1000.0)),
                          static_cast<std::int32_t>(std::lround(p.y() * 1000.0))});
  }
  order.command.path_points = static_cast<std::uint16_t>(order.path.size());
  if (!order.path.empty()) {
    order.command.goal_x_mm = order.path.back().x_mm;
    order.command.goal_y_mm = order.path.back().y_mm;
  }
  return order;
}

proto::RobotLink::Order stop(std::uint64_t id, std::uint32_t revision = 1) {
  proto::RobotLink::Order order;
  order.command.id = id;
  order.command.revision = revision;
  order.command.kind = CommandKind::stop;
  order.command.issuer = "Grace";
  order.command.expires_clock_ms = 1'000'000;
  return order;
}

/// A robot on flat ground, its driver, and everything that the driver reported.
class DriverTest : public ::testing::Test {
 protected:
  Driver driver{DriverConfig{}};
  Pose pose;
  MonotonicTime clock = seconds(100);
  std::optional<Duration> silence = Duration{};
  CellLookup cells = [](CellIndex) { return Cell{0, 200}; };
  std::vector<CommandReport> reports;
  DriveCommand wheels;

  void take(const proto::RobotLink::Order& order) {
    driver.take(order, pose, clock);
    listen();
  }
  void step() {
    wheels = driver.step(pose, cells, kCellMm, 25, clock, silence);
    testing::roll(pose, wheels);
    clock += from_seconds(testing::kStepS);
    listen();
  }
  void run(Duration time) {
    for (const MonotonicTime end = clock + time; clock < end;) step();
  }
  [[nodiscard]] std::vector<CommandState> states() const {
    std::vector<CommandState> states;
    for (const CommandReport& report : reports) states.push_back(report.state);
    return states;
  }
  void listen() {
    for (CommandReport& report : driver.take_reports()) reports.push_back(std::move(report));
  }
  /// 0.5 m deep, 1 m wide, across the way.
  void box_at(double x_m) {
    cells = [x_m](CellIndex cell) {
      const double ahead_m = cell.x * kCellM - x_m;
      const bool box = ahead_m >= 0.0 && ahead_m < 0.5 && cell.y >= -4 && cell.y < 4;
      return Cell{box ? 1000 : 0, 200};
    };
  }
  void wall_at(double x_m) {
    cells = [x_m](CellIndex cell) { return Cell{cell.x * kCellM >= x_m ? 1000 : 0, 200}; };
  }
};

TEST_F(DriverTest, StandsStillWithoutACommand) {
  run(seconds(1));
  EXPECT_EQ(wheels.speed_m_s, 0.0);
  EXPECT_EQ(driver.state(), DriveState::idle);
  EXPECT_THAT(reports, IsEmpty());
}

TEST_F(DriverTest, DrivesToTheGoalAndSaysSo) {
  take(go_to(7, {{0, 0}, {3, 0}, {3, 2}}));
  run(seconds(40));
  EXPECT_LE((testing::place_of(pose) - Eigen::Vector2d(3, 2)).norm(), 0.06);
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::arrived));
  EXPECT_EQ(reports.back().command, 7U);
  EXPECT_EQ(reports.back().why, "");
  EXPECT_EQ(driver.state(), DriveState::idle);
  EXPECT_EQ(driver.command(), 0U);
}

TEST_F(DriverTest, TurnsToTheHeadingAtTheGoalBeforeItHasArrived) {
  std::uint64_t id = 0;
  for (const double heading_deg : {90.0, -179.0, 180.0, 10.0}) {
    pose = {};
    reports.clear();
    proto::RobotLink::Order order = go_to(++id, {{0, 0}, {1.5, 0}});
    order.command.goal_yaw_1e4rad =
        static_cast<std::int32_t>(std::lround(radians(heading_deg) * 1e4));
    take(order);
    double fastest_rad_s = 0.0;
    for (const MonotonicTime end = clock + seconds(30); driver.busy() && clock < end;) {
      step();
      fastest_rad_s = std::max(fastest_rad_s, std::abs(wheels.turn_rate_rad_s));
    }
    EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::arrived));
    EXPECT_LE(std::abs(wrap_angle(pose.yaw_rad - radians(heading_deg))), radians(3.0))
        << heading_deg;
    EXPECT_LE((testing::place_of(pose) - Eigen::Vector2d(1.5, 0)).norm(), 0.06);
    EXPECT_LE(fastest_rad_s, DriverConfig{}.follower.max_turn_rad_s);
    EXPECT_EQ(wheels.turn_rate_rad_s, 0.0);
  }
}

TEST_F(DriverTest, TurnsTheShorterWayToTheHeading) {
  pose.yaw_rad = radians(170.0);
  proto::RobotLink::Order order = go_to(7, {{0, 0}, {0.01, 0}});
  order.command.goal_yaw_1e4rad = static_cast<std::int32_t>(std::lround(radians(-170.0) * 1e4));
  take(order);
  step();
  EXPECT_GT(wheels.turn_rate_rad_s, 0.0);
  EXPECT_EQ(wheels.speed_m_s, 0.0);
}

TEST_F(DriverTest, GoesBackToTheGoalWhenTurningHasCarriedItAway) {
  proto::RobotLink::Order order = go_to(7, {{0, 0}, {1.5, 0}});
  order.command.goal_yaw_1e4rad = 15'708;
  take(order);
  for (int i = 0; i < 400 && pose.yaw_rad < 0.5; ++i) step();
  ASSERT_EQ(driver.state(), DriveState::driving);
  pose.y_m += 0.5;
  run(seconds(30));
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::arrived));
  EXPECT_NEAR(pose.yaw_rad, radians(90.0), radians(3.0));
  EXPECT_LE((testing::place_of(pose) - Eigen::Vector2d(1.5, 0)).norm(), 3.0 * 0.06);
}

TEST_F(DriverTest, StopsTurningWhenItsTimeIsOver) {
  proto::RobotLink::Order order = go_to(7, {{0, 0}, {0.01, 0}});
  order.command.goal_yaw_1e4rad = 31'416;
  order.command.expires_clock_ms = 101'000;
  take(order);
  run(seconds(2));
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::expired));
  EXPECT_EQ(wheels.turn_rate_rad_s, 0.0);
}

TEST_F(DriverTest, SaysHowFarFromTheGoalAPathToTheNearestPlaceEnds) {
  proto::RobotLink::Order order = go_to(7, {{0, 0}, {2, 0}});
  order.command.goal_x_mm = 3500;
  take(order);
  run(seconds(20));
  EXPECT_EQ(reports.back().state, CommandState::arrived);
  EXPECT_THAT(reports.back().why, HasSubstr("1.5 m from the goal"));
}

TEST_F(DriverTest, ShowsWhatItDoesWhileItDrives) {
  take(go_to(7, {{0, 0}, {5, 0}}));
  run(seconds(2));
  EXPECT_EQ(driver.state(), DriveState::driving);
  EXPECT_EQ(driver.command(), 7U);
  EXPECT_NEAR(driver.to_go_m(), 5.0 - pose.x_m, 0.05);
}

TEST_F(DriverTest, DrivesSlowlyWhileItIsNotSureWhereItIs) {
  take(go_to(7, {{0, 0}, {5, 0}}));
  run(seconds(3));
  EXPECT_GT(wheels.speed_m_s, 0.3);
  driver.set_localization(LocalizationState::unsure, "the last map did not fit");
  run(seconds(1));
  EXPECT_LE(wheels.speed_m_s, 0.25);
  EXPECT_GT(wheels.speed_m_s, 0.0);
  driver.set_localization(LocalizationState::localized, "");
  run(seconds(20));
  EXPECT_EQ(reports.back().state, CommandState::arrived);
}

TEST_F(DriverTest, LooksAroundOnTheSpotWhenItIsLostAndGoesOnWhenItHasFoundItself) {
  take(go_to(7, {{0, 0}, {5, 0}}));
  run(seconds(2));
  const Pose before = pose;
  driver.set_localization(LocalizationState::lost, "nothing fits here");
  run(seconds(4));
  EXPECT_NEAR(pose.x_m, before.x_m, 0.05);
  EXPECT_GT(std::abs(pose.yaw_rad), 1.0);
  EXPECT_EQ(driver.state(), DriveState::blocked);
  EXPECT_EQ(reports.back().state, CommandState::accepted) << "another path would not help";
  driver.set_localization(LocalizationState::localized, "");
  run(seconds(30));
  EXPECT_EQ(reports.back().state, CommandState::arrived);
}

TEST_F(DriverTest, StopsWhenAFewTurnsHaveNotShownWhereItIs) {
  take(go_to(7, {{0, 0}, {5, 0}}));
  driver.set_localization(LocalizationState::lost, "nothing fits here");
  run(seconds(60));
  EXPECT_EQ(wheels.turn_rate_rad_s, 0.0);
  EXPECT_EQ(reports.back().state, CommandState::stopped);
  EXPECT_THAT(reports.back().why, HasSubstr("lost: nothing fits here"));
}

TEST_F(DriverTest, RefusesAGoalWithoutAPath) {
  take(go_to(7, {}));
  EXPECT_THAT(states(), ElementsAre(CommandState::refused));
  EXPECT_THAT(reports.back().why, HasSubstr("no path"));
  EXPECT_FALSE(driver.busy());
}

TEST_F(DriverTest, DoesNotBeginWhatIsTooOld) {
  clock = seconds(1000);
  take(go_to(7, {{0, 0}, {3, 0}}));
  run(seconds(1));
  EXPECT_THAT(states(), ElementsAre(CommandState::expired));
  EXPECT_EQ(pose.x_m, 0.0);
}

TEST_F(DriverTest, StopsWhenTheCommandExpiresOnTheWay) {
  proto::RobotLink::Order order = go_to(7, {{0, 0}, {10, 0}});
  order.command.expires_clock_ms = 103'000;
  take(order);
  run(seconds(4));
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::expired));
  EXPECT_EQ(wheels.speed_m_s, 0.0);
  EXPECT_EQ(driver.state(), DriveState::stopped);
  EXPECT_LE(pose.x_m, 3.0 * DriverConfig{}.follower.max_speed_m_s + 1e-9);
}

TEST_F(DriverTest, StopsWhenTheLinkIsSilentForTooLong) {
  take(go_to(7, {{0, 0}, {10, 0}}));
  silence = milliseconds(5'001);
  step();
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::stopped));
  EXPECT_THAT(reports.back().why, HasSubstr("silent for 5.0 s"));
  EXPECT_EQ(wheels.speed_m_s, 0.0);
}

TEST_F(DriverTest, BearsASilenceUpToTheTimeout) {
  take(go_to(7, {{0, 0}, {10, 0}}));
  silence = seconds(5);
  step();
  EXPECT_GT(wheels.speed_m_s, 0.0);
}

TEST_F(DriverTest, DrivesOnInSilenceWhenToldToProceed) {
  proto::RobotLink::Order order = go_to(7, {{0, 0}, {3, 0}});
  order.command.on_link_loss = OnLinkLoss::proceed;
  take(order);
  silence = seconds(600);
  run(seconds(20));
  EXPECT_EQ(reports.back().state, CommandState::arrived);
}

/// Drives round a corner, and then the link is lost.
class LinkLostAfterACorner : public DriverTest {
 protected:
  LinkLostAfterACorner() {
    proto::RobotLink::Order order = go_to(7, {{0, 0}, {2, 0}, {2, 9}});
    order.command.on_link_loss = OnLinkLoss::retrace;
    take(order);
    run(seconds(14));
    turned_back_m = testing::place_of(pose);
    EXPECT_GT(turned_back_m.y(), 1.5);
    silence = seconds(6);
  }
  Eigen::Vector2d turned_back_m;
};

TEST_F(LinkLostAfterACorner, GoesBackTheWayItCameUntilTheServerIsHeard) {
  run(seconds(10));
  EXPECT_TRUE(driver.busy());
  EXPECT_LT(pose.y_m, turned_back_m.y() - 1.0);
  silence = Duration{};
  step();
  EXPECT_EQ(reports.back().state, CommandState::stopped);
  EXPECT_THAT(reports.back().why, HasSubstr("came back"));
  EXPECT_EQ(wheels.speed_m_s, 0.0);
}

TEST_F(LinkLostAfterACorner, EndsWhereItBeganWhenTheServerStaysSilent) {
  double farthest_off_m = 0.0;
  for (int i = 0; i < 400 && driver.busy(); ++i) {
    run(milliseconds(200));
    const bool first_part = pose.y_m < 1.0;
    farthest_off_m = std::max(farthest_off_m, std::abs(first_part ? pose.y_m : pose.x_m - 2.0));
  }
  EXPECT_EQ(reports.back().state, CommandState::stopped);
  EXPECT_THAT(reports.back().why, HasSubstr("all the way"));
  EXPECT_LT(testing::place_of(pose).norm(), 0.1);
  EXPECT_LT(farthest_off_m, 1.01) << "it takes the corner again, not a short cut";
}

TEST_F(LinkLostAfterACorner, TakesANewGoalOnTheWayBack) {
  run(seconds(3));
  silence = Duration{};
  take(go_to(8, {testing::place_of(pose), {2, 3}}));
  run(seconds(30));
  EXPECT_EQ(reports.back().state, CommandState::arrived);
  EXPECT_EQ(reports.back().command, 8U);
}

TEST_F(DriverTest, LeavesAGoalForANewerOne) {
  take(go_to(7, {{0, 0}, {3, 0}}));
  run(seconds(1));
  take(go_to(8, {testing::place_of(pose), {0, 2}}));
  run(seconds(30));
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::superseded,
                                    CommandState::accepted, CommandState::arrived));
  EXPECT_EQ(reports[1].command, 7U);
  EXPECT_EQ(reports[3].command, 8U);
  EXPECT_LE((testing::place_of(pose) - Eigen::Vector2d(0, 2)).norm(), 0.06);
}

TEST_F(DriverTest, TakesANewPathForTheSameGoalWithoutCallingItSuperseded) {
  take(go_to(7, {{0, 0}, {3, 0}}));
  run(seconds(1));
  take(go_to(7, {testing::place_of(pose), {0, 2}}, 2));
  run(seconds(30));
  EXPECT_THAT(states(),
              ElementsAre(CommandState::accepted, CommandState::accepted, CommandState::arrived));
  EXPECT_EQ(reports.back().revision, 2U);
}

TEST_F(DriverTest, StopsAtOnceWhenTold) {
  take(go_to(7, {{0, 0}, {10, 0}}));
  run(seconds(2));
  take(stop(8));
  step();
  EXPECT_EQ(wheels.speed_m_s, 0.0);
  EXPECT_THAT(states(),
              ElementsAre(CommandState::accepted, CommandState::superseded, CommandState::stopped));
  EXPECT_EQ(reports[1].command, 7U);
  EXPECT_EQ(reports[2].command, 8U);
}

TEST_F(DriverTest, IsCancelledByAHigherRevisionOfItsOwnCommand) {
  take(go_to(7, {{0, 0}, {10, 0}}));
  run(seconds(2));
  take(stop(7, 2));
  step();
  EXPECT_EQ(wheels.speed_m_s, 0.0);
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::stopped));
  EXPECT_EQ(reports.back().command, 7U);
  EXPECT_EQ(reports.back().revision, 2U);
}

TEST_F(DriverTest, AnswersAStopWhenItStandsAnyway) {
  take(stop(8));
  EXPECT_THAT(states(), ElementsAre(CommandState::stopped));
}

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
  std::vector<Eigen::Vector2d> path_m;
  for (std::size_t i = 0; i < proto::kMaxPathPoints; ++i) path_m.emplace_back(0.002 * double(i), 0);
  proto::RobotLink::Order order = go_to(7, path_m);
  order.command.goal_x_mm = 9'000;
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
