#include "core/pose/pose.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "core/common/angle.h"

namespace cairn {
namespace {

using Eigen::Vector3d;

constexpr double kExact = 1e-12;

void expect_near(const Vector3d& actual, const Vector3d& expected, double tolerance = kExact) {
  EXPECT_LT((actual - expected).norm(), tolerance)
      << "is " << actual.transpose() << ", should be " << expected.transpose();
}

TEST(Pose, YawTurnsForwardToTheLeft) {
  expect_near(to_transform({.yaw_rad = radians(90)}) * Vector3d(1, 0, 0), {0, 1, 0});
}

TEST(Pose, PositivePitchLowersTheNose) {
  const double c = std::cos(radians(30));
  expect_near(to_transform({.pitch_rad = radians(30)}) * Vector3d(1, 0, 0), {c, 0, -0.5});
}

TEST(Pose, PositiveRollRaisesTheLeftSide) {
  expect_near(to_transform({.roll_rad = radians(90)}) * Vector3d(0, 1, 0), {0, 0, 1});
}

TEST(Pose, RollIsAppliedFirstThenPitchThenYawThenTheTranslation) {
  const Pose pose{.x_m = 10,
                  .y_m = 20,
                  .z_m = 30,
                  .roll_rad = radians(90),
                  .pitch_rad = radians(90),
                  .yaw_rad = radians(90)};
  // (1,2,3) –roll→ (1,-3,2) –pitch→ (2,-3,-1) –yaw→ (3,2,-1).
  expect_near(to_transform(pose) * Vector3d(1, 2, 3), {13, 22, 29});
}

TEST(Pose, ComesBackFromItsTransform) {
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> metres(-1000, 1000);
  std::uniform_real_distribution<double> turn(-3.14, 3.14);
  std::uniform_real_distribution<double> tilt(-1.57, 1.57);
  for (int i = 0; i < 1000; ++i) {
    const Pose pose{metres(random), metres(random), metres(random),
                    turn(random),   tilt(random),   turn(random)};
    const Pose back = from_transform(to_transform(pose));
    EXPECT_NEAR(back.x_m, pose.x_m, kExact);
    EXPECT_NEAR(back.y_m, pose.y_m, kExact);
    EXPECT_NEAR(back.z_m, pose.z_m, kExact);
    EXPECT_NEAR(back.roll_rad, pose.roll_rad, 1e-9) << "seed " << kSeed << " case " << i;
    EXPECT_NEAR(back.pitch_rad, pose.pitch_rad, 1e-9) << "seed " << kSeed << " case " << i;
    EXPECT_NEAR(back.yaw_rad, pose.yaw_rad, 1e-9) << "seed " << kSeed << " case " << i;
  }
}

TEST(Pose, LookingStraightUpOrDownChoosesRollZeroAndKeepsTheTransform) {
  for (const double pitch : {radians(90), radians(-90)}) {
    const Pose pose{.roll_rad = 0.3, .pitch_rad = pitch, .yaw_rad = 0.8};
    const Pose back = from_transform(to_transform(pose));
    EXPECT_EQ(back.roll_rad, 0.0);
    EXPECT_TRUE(to_transform(back).isApprox(to_transform(pose), 1e-9));
  }
}

TEST(Pose, IsFiniteOnlyWhenEveryComponentIs) {
  EXPECT_TRUE(is_finite(Pose{}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (double Pose::*member :
       {&Pose::x_m, &Pose::y_m, &Pose::z_m, &Pose::roll_rad, &Pose::pitch_rad, &Pose::yaw_rad}) {
    Pose pose;
    pose.*member = nan;
    EXPECT_FALSE(is_finite(pose));
    pose.*member = -infinite;
    EXPECT_FALSE(is_finite(pose));
  }
}

}  // namespace
}  // namespace cairn
