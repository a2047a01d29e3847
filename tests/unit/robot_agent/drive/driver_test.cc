// What the driver makes of commands, of the link and of not knowing where it is.

#include "tests/unit/robot_agent/drive/driver_fixture.h"

namespace cairn::agent {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

}  // namespace
}  // namespace cairn::agent
