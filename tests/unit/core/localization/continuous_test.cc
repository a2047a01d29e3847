#include "core/localization/continuous.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/common/angle.h"
#include "tests/unit/core/localization/test_ground.h"
#include "tests/unit/core/localization/test_laser.h"

namespace cairn {
namespace {

using test::down_looking;
using test::look;

/// A robot that really drives along x while it believes to be off by `off`.
class Drive {
 public:
  explicit Drive(const ContinuousConfig& config) : localization_(config) {}

  /// Moves and looks; returns the answer if a map became mature.
  std::optional<Registration> step(const HeightMap& long_term) {
    truth_.x_m += 0.05;
    truth_.z_m = test::RichGround{}(truth_.x_m, truth_.y_m);
    localization_.move(believed());
    for (const double pitch_deg : {15.0, 30.0, 50.0}) {
      const LaserSpec laser = down_looking(pitch_deg);
      localization_.take_scan(look(laser, truth_), laser, believed(), 0.0);
    }
    const auto answer = localization_.localize(long_term, test::sigmas(sigma_m_, radians(3.0)));
    if (answer && answer->accepted) {
      off_ = {answer->T_site_robot.x_m - truth_.x_m,
              answer->T_site_robot.y_m - truth_.y_m,
              answer->T_site_robot.z_m - truth_.z_m,
              0.0,
              0.0,
              answer->T_site_robot.yaw_rad - truth_.yaw_rad};
    }
    return answer;
  }
  std::optional<Registration> step_until_mature(const HeightMap& long_term) {
    for (int i = 0; i < 200; ++i) {
      if (auto answer = step(long_term)) return answer;
    }
    return std::nullopt;
  }

  [[nodiscard]] Pose believed() const {
    return {truth_.x_m + off_.x_m,        truth_.y_m + off_.y_m, truth_.z_m + off_.z_m, 0.0, 0.0,
            truth_.yaw_rad + off_.yaw_rad};
  }

  Pose truth_{-4.0, 0.3, 0.0, 0.0, 0.0, 0.0};
  Pose off_;
  double sigma_m_ = 0.1;  ///< What dead reckoning says of itself.
  ContinuousLocalization localization_;
};

HeightMap rich_map() {
  std::mt19937_64 random(1);
  return test::long_term_of(test::RichGround{}, random);
}

TEST(ContinuousLocalization, CorrectsTheErrorOfTheRobotsPose) {
  const HeightMap map = rich_map();
  Drive drive({});
  drive.off_ = {0.15, -0.1, 0.05, 0.0, 0.0, radians(1.5)};
  for (int corrections = 0; corrections < 4; ++corrections) {
    const auto answer = drive.step_until_mature(map);
    ASSERT_TRUE(answer);
    EXPECT_TRUE(answer->accepted) << answer->why;
  }
  EXPECT_EQ(drive.localization_.state(), LocalizationState::localized);
  EXPECT_NEAR(drive.off_.x_m, 0.0, 0.04);
  EXPECT_NEAR(drive.off_.y_m, 0.0, 0.04);
  EXPECT_NEAR(drive.off_.z_m, 0.0, 0.04);
  EXPECT_NEAR(drive.off_.yaw_rad, 0.0, radians(0.7));
}

TEST(ContinuousLocalization, HoldsABoundedNumberOfMapsEvenIfNobodyAsksForAnswers) {
  ContinuousConfig config;
  config.overlapping_maps = 3;
  ContinuousLocalization localization(config);
  for (int i = 0; i < 1000; ++i) localization.move({0.05 * i, 0.0, 0.0});
  EXPECT_LE(localization.maps(), 4U);
}

TEST(ContinuousLocalization, ARobotThatStandsStillNeverMatures) {
  ContinuousLocalization localization({});
  for (int i = 0; i < 1000; ++i) localization.move({});
  EXPECT_FALSE(localization.mature());
  EXPECT_EQ(localization.maps(), 1U);
}

TEST(ContinuousLocalization, TurningOnTheSpotMaturesAMapToo) {
  ContinuousLocalization localization({});
  const LaserSpec laser = down_looking(30.0);
  for (int i = 0; i < 40; ++i) {
    const Pose robot{0.0, 0.0, 0.0, 0.0, 0.0, wrap_angle(0.05 * i)};
    localization.move(robot);
    localization.take_scan(look(laser, robot), laser, robot, 0.0);
  }
  EXPECT_TRUE(localization.mature());
}

TEST(ContinuousLocalization, IgnoresPosesThatAreNotFinite) {
  ContinuousLocalization localization({});
  localization.move({std::numeric_limits<double>::infinity(), 0.0, 0.0});
  EXPECT_EQ(localization.maps(), 0U);
  EXPECT_FALSE(localization.localize(rich_map(), test::sigmas(0.1, 0.1)));
}

TEST(ContinuousLocalization, OnFeaturelessGroundStaysLocalizedAndInventsNothing) {
  std::mt19937_64 random(1);
  const HeightMap map = test::long_term_of(test::FlatGround{}, random, 1.0);
  ContinuousLocalization localization({});
  const Pose off{0.2, -0.15, 0.05, 0.0, 0.0, radians(1.0)};
  double corrected_z_m = off.z_m;
  int answers = 0;
  for (int i = 0; i < 120; ++i) {
    const Pose truth{0.05 * i - 3.0, 0.3, 0.0, 0.0, 0.0, 0.0};
    const Pose believed{truth.x_m + off.x_m, truth.y_m + off.y_m, corrected_z_m, 0.0, 0.0,
                        off.yaw_rad};
    localization.move(believed);
    for (const double pitch_deg : {15.0, 30.0, 50.0}) {
      const LaserSpec laser = down_looking(pitch_deg);
      localization.take_scan(look(laser, truth, test::FlatGround{}), laser, believed, 0.0);
    }
    const auto answer = localization.localize(map, test::sigmas(0.3, radians(3.0)));
    if (!answer) continue;
    ++answers;
    ASSERT_TRUE(answer->accepted) << answer->why;
    EXPECT_FALSE(answer->position_observable);
    EXPECT_NEAR(answer->T_site_robot.x_m, truth.x_m + off.x_m, 0.02);
    EXPECT_NEAR(answer->T_site_robot.y_m, truth.y_m + off.y_m, 0.02);
    EXPECT_NEAR(answer->T_site_robot.yaw_rad, off.yaw_rad, radians(0.2));
    EXPECT_NEAR(answer->T_site_robot.z_m, 0.0, 0.02);
    EXPECT_GT(answer->covariance(0, 0), 0.28 * 0.28);
    corrected_z_m = answer->T_site_robot.z_m;
  }
  EXPECT_GT(answers, 10);
  EXPECT_EQ(localization.state(), LocalizationState::localized);
}

TEST(ContinuousLocalization, WhereThereIsNoMapNothingSpeaksAgainstItsPlace) {
  Drive drive{ContinuousConfig{}};
  for (int i = 0; i < 20; ++i) {
    const auto answer = drive.step_until_mature(HeightMap(test::kCellMm));
    ASSERT_TRUE(answer);
    EXPECT_FALSE(answer->accepted);
    EXPECT_EQ(drive.localization_.state(), LocalizationState::localized);
  }
}

HeightMap map_of_elsewhere() {
  std::mt19937_64 random(3);
  const auto elsewhere = [](double x, double y) { return test::RichGround{}(x + 40.0, y - 70.0); };
  return test::long_term_of(elsewhere, random);
}

TEST(ContinuousLocalization, OnAMapOfAnotherPlaceIsLostAfterSomeRefusals) {
  const HeightMap other = map_of_elsewhere();
  ContinuousConfig config;
  Drive drive(config);
  for (int i = 1; i <= config.refusals_until_lost; ++i) {
    EXPECT_NE(drive.localization_.state(), LocalizationState::lost);
    const auto answer = drive.step_until_mature(other);
    ASSERT_TRUE(answer);
    EXPECT_FALSE(answer->accepted);
    EXPECT_EQ(drive.localization_.refusals(), i);
  }
  EXPECT_EQ(drive.localization_.state(), LocalizationState::lost);
}

TEST(ContinuousLocalization, ALostRobotFindsItselfAgainWhenTwoMapsWithoutACommonScanAgree) {
  const HeightMap other = map_of_elsewhere();
  const HeightMap map = rich_map();
  Drive drive({});
  drive.off_ = {0.4, 0.3, 0.0, 0.0, 0.0, radians(2.0)};
  while (drive.localization_.state() != LocalizationState::lost) {
    ASSERT_TRUE(drive.step_until_mature(other));
  }
  bool found = false;
  int answers = 0;
  while (!found && answers < 20) {
    const auto answer = drive.step_until_mature(map);
    ASSERT_TRUE(answer);
    found = answer->accepted;
    ++answers;
  }
  ASSERT_TRUE(found);
  // The first that agrees with the first answer and begun after it.
  EXPECT_GT(answers, ContinuousConfig{}.overlapping_maps);
  EXPECT_EQ(drive.localization_.state(), LocalizationState::localized);
  EXPECT_NEAR(drive.off_.x_m, 0.0, 0.1);
  EXPECT_NEAR(drive.off_.y_m, 0.0, 0.1);
}

}  // namespace
}  // namespace cairn
