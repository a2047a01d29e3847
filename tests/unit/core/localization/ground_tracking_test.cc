#include "core/localization/ground_tracking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/common/angle.h"
#include "tests/unit/core/localization/test_ground.h"
#include "tests/unit/core/localization/test_laser.h"

namespace cairn {
namespace {

using test::down_looking;
using test::look;

/// Gentle hills, even enough to be ground everywhere.
struct Hills {
  double operator()(double x, double y) const {
    return 0.4 * std::sin(0.3 * x + 0.3) * std::cos(0.25 * y);
  }
};

/// The same, with a box ahead that covers `from_y_m` and what is to its left.
struct HillsWithBox {
  double from_y_m;
  double operator()(double x, double y) const {
    return Hills{}(x, y) + (x > 1.0 && y > from_y_m ? 0.5 : 0.0);
  }
};

constexpr double kInclineSigmaRad = 0.05;

class GroundTrackingTest : public ::testing::Test {
 protected:
  std::mt19937_64 random_{3};
  HeightMap map_ = test::long_term_of(Hills{}, random_, 1.0);
  GroundTracking tracking_{GroundTrackingConfig{}};
  LaserSpec laser_ = down_looking(25.0);
  Pose truth_{0.3, -0.2, Hills{}(0.3, -0.2), 0.02, -0.03, 0.4};

  /// What comes of a sweep of a robot that errs.
  template <class Ground = Hills>
  std::optional<Unevenness> lay(const Pose& believed, const Ground& ground = {}) {
    return tracking_.lay(look(laser_, truth_, ground), laser_, believed, map_, kInclineSigmaRad);
  }
};

TEST_F(GroundTrackingTest, FindsARobotThatStandsHigherThanItBelieves) {
  tracking_.restart(0.1);
  Pose believed = truth_;
  believed.z_m -= 0.08;
  const auto off = lay(believed);
  ASSERT_TRUE(off);
  // Height and pitch of a robot that sees but one line ahead cannot be told apart; there they
  // agree.
  EXPECT_NEAR(off->z_m - 1.7 * off->pitch_rad, 0.08, 0.015);
  EXPECT_NEAR(off->roll_rad, 0.0, 0.01);
}

TEST_F(GroundTrackingTest, FindsWhatALaggingInclinometerMissed) {
  tracking_.restart(0.01);
  Pose believed = truth_;
  believed.pitch_rad += 0.06;
  believed.roll_rad -= 0.04;
  const auto off = lay(believed);
  ASSERT_TRUE(off);
  EXPECT_NEAR(off->pitch_rad, -0.06, 0.01);
  EXPECT_NEAR(off->roll_rad, 0.04, 0.01);
  EXPECT_LT(off->incline_sigma_rad, kInclineSigmaRad / 3.0);
}

TEST_F(GroundTrackingTest, TakesWhatStandsThereNewForNoGround) {
  tracking_.restart(0.03);
  Pose believed = truth_;
  believed.z_m -= 0.04;
  const auto off = lay(believed, HillsWithBox{1.5});
  ASSERT_TRUE(off);
  EXPECT_NEAR(off->z_m - 1.7 * off->pitch_rad, 0.04, 0.02);
}

TEST_F(GroundTrackingTest, SaysNothingWhereTheMapKnowsNothing) {
  const HeightMap nothing(test::kCellMm);
  EXPECT_FALSE(tracking_.lay(look(laser_, truth_, Hills{}), laser_, truth_, nothing, 0.01));
}

TEST_F(GroundTrackingTest, SaysNothingWhereTheGroundIsAnother) {
  tracking_.restart(0.05);
  const auto other = [](double x, double y) { return 0.3 * std::sin(1.1 * x) * std::sin(1.3 * y); };
  EXPECT_FALSE(lay(truth_, other));
}

TEST_F(GroundTrackingTest, IsLessSureOfItsHeightTheFartherItGoesWithoutKnownGround) {
  ASSERT_TRUE(lay(truth_));
  const double after_sweep_m = tracking_.z_sigma_m();
  EXPECT_LT(after_sweep_m, 0.02);
  tracking_.move(2.0, 0.0, 0.01);
  EXPECT_NEAR(tracking_.z_sigma_m(), after_sweep_m + 0.02, 1e-9);
  tracking_.move(0.0, 0.2, 0.01);
  EXPECT_GT(tracking_.z_sigma_m(), after_sweep_m + 0.04);
  tracking_.move(1e6, 0.0, 0.01);
  EXPECT_LE(tracking_.z_sigma_m(), GroundTrackingConfig{}.most_sigma_m);
}

TEST_F(GroundTrackingTest, IsInDoubtWhileTheRobotTipsUnnoticed) {
  Pose tipping = truth_;
  tipping.pitch_rad += 0.2;
  const Scan scan = look(laser_, tipping, Hills{});
  EXPECT_FALSE(tracking_.lay(scan, laser_, truth_, map_, 0.004));
  EXPECT_TRUE(tracking_.in_doubt());
  ASSERT_TRUE(lay(truth_));
  EXPECT_FALSE(tracking_.in_doubt());
}

TEST_F(GroundTrackingTest, AStepOfTwentyCentimetresTakesTwoSweeps) {
  tracking_.restart(0.15);
  Pose believed = truth_;
  believed.z_m -= 0.2;
  EXPECT_FALSE(lay(believed)) << "one sweep may have met the side of something";
  EXPECT_TRUE(tracking_.in_doubt());
  const auto off = lay(believed);
  ASSERT_TRUE(off);
  EXPECT_NEAR(off->z_m - 1.7 * off->pitch_rad, 0.2, 0.03);
}

TEST_F(GroundTrackingTest, IgnoresASweepWithoutHits) {
  Scan scan = look(laser_, truth_, Hills{});
  for (float& range_m : scan.range_m) range_m = std::nanf("");
  EXPECT_FALSE(tracking_.lay(scan, laser_, truth_, map_, 0.01));
}

}  // namespace
}  // namespace cairn
