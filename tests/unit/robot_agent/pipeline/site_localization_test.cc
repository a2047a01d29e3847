#include "robot_agent/pipeline/site_localization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/common/angle.h"
#include "tests/unit/core/localization/test_ground.h"
#include "tests/unit/core/localization/test_laser.h"

namespace cairn::agent {
namespace {

using test::down_looking;
using test::look;

constexpr SiteLocalization::Surroundings kGiven{.old_share = 1.0, .given = true};
constexpr SiteLocalization::Surroundings kOwn{.old_share = 1.0, .given = false};
constexpr SiteLocalization::Surroundings kNew{.old_share = 0.1, .given = true};

/// Other ground than RichGround.
struct OtherGround {
  double operator()(double x, double y) const { return test::RichGround{}(y - 31.0, x + 17.0); }
};

class SiteLocalizationTest : public ::testing::Test {
 protected:
  std::mt19937_64 random_{5};
  HeightMap map_ = test::long_term_of(test::RichGround{}, random_, 1.0);
  SiteLocalization localization_{MapperConfig{}};
  Pose truth_{-3.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  Pose off_{0.12, -0.1, 0.0, 0.0, 0.0, 0.02};
  int corrections_ = 0;

  Pose believed() const {
    return {truth_.x_m + off_.x_m, truth_.y_m + off_.y_m, truth_.z_m, 0.0, 0.0, off_.yaw_rad};
  }
  /// Drives on and applies what it is told.
  void drive(const HeightMap& map, const SiteLocalization::Surroundings& around, int steps,
             double sigma_m = 0.2) {
    for (int i = 0; i < steps && localization_.state() != LocalizationState::lost; ++i) {
      truth_.x_m += 0.05;
      truth_.z_m = test::RichGround{}(truth_.x_m, truth_.y_m);
      localization_.move(believed());
      for (const double pitch_deg : {15.0, 30.0, 50.0}) {
        const LaserSpec laser = down_looking(pitch_deg);
        localization_.take_scan(look(laser, truth_), laser, believed(), 0.0);
      }
      const auto told =
          localization_.localize(map, around, believed(), test::sigmas(sigma_m, radians(2.0)));
      if (!told) continue;
      ++corrections_;
      off_ = {
          told->T_site_robot.x_m - truth_.x_m, told->T_site_robot.y_m - truth_.y_m, 0.0, 0.0, 0.0,
          told->T_site_robot.yaw_rad};
    }
  }
};

TEST_F(SiteLocalizationTest, PutsTheRobotRightOnAGivenMap) {
  drive(map_, kGiven, 140);
  EXPECT_GT(corrections_, 1);
  EXPECT_EQ(localization_.accepted(), static_cast<std::uint64_t>(corrections_));
  EXPECT_EQ(localization_.state(), LocalizationState::localized);
  EXPECT_LT(std::hypot(off_.x_m, off_.y_m), 0.05);
}

TEST_F(SiteLocalizationTest, SaysSoOnNewGroundAndAsksNothing) {
  drive(map_, kNew, 100);
  EXPECT_EQ(corrections_, 0);
  EXPECT_EQ(localization_.refused(), 0U);
  EXPECT_EQ(localization_.why(), "on new ground");
}

TEST_F(SiteLocalizationTest, ASureRobotDoesNotAskItsOwnMap) {
  drive(map_, kOwn, 100, 0.05);
  EXPECT_EQ(corrections_, 0);
  EXPECT_EQ(localization_.refused(), 0U);
}

TEST_F(SiteLocalizationTest, AnUnsureOneDoes) {
  drive(map_, kOwn, 140, 0.4);
  EXPECT_GT(corrections_, 0);
}

TEST_F(SiteLocalizationTest, IsLostOnTheMapOfAnotherPlaceAndSaysWhy) {
  const HeightMap other = test::long_term_of(OtherGround{}, random_, 1.0);
  drive(other, kGiven, 400);
  EXPECT_EQ(corrections_, 0);
  EXPECT_EQ(localization_.state(), LocalizationState::lost);
  EXPECT_GT(localization_.refused(), 1U);
  EXPECT_FALSE(localization_.why().empty());
}

TEST_F(SiteLocalizationTest, IsNeverLostByItsOwnMap) {
  const HeightMap other = test::long_term_of(OtherGround{}, random_, 1.0);
  drive(other, kOwn, 250, 0.4);
  EXPECT_NE(localization_.state(), LocalizationState::lost);
}

TEST_F(SiteLocalizationTest, StartsLostWithoutAPoseAndIsUnsureOnceFound) {
  MapperConfig unknown;
  unknown.start_known = false;
  SiteLocalization lost(unknown);
  EXPECT_EQ(lost.state(), LocalizationState::lost);
  SiteMatch nothing;
  nothing.why = "nothing fits";
  lost.take(nothing);
  EXPECT_EQ(lost.state(), LocalizationState::lost);
  EXPECT_EQ(lost.why(), "nothing fits");
  SiteMatch found;
  found.accepted = true;
  lost.take(found);
  EXPECT_EQ(lost.state(), LocalizationState::unsure);
  EXPECT_EQ(lost.accepted(), 1U);
}

}  // namespace
}  // namespace cairn::agent
