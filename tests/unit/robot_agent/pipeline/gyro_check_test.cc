#include "robot_agent/pipeline/gyro_check.h"

#include <gtest/gtest.h>

#include "core/common/angle.h"

namespace cairn::agent {
namespace {

const GyroCalibration kNew{GyroCalibrationConfig{}};

TEST(GyroCheck, BelievesWhatTheGyroMayHaveMissed) {
  GyroCheck check;
  EXPECT_TRUE(check.believes(radians(0.2), kNew)) << "a match's own error";
  check.move(radians(360.0), 20.0);
  EXPECT_TRUE(check.believes(radians(-5.0), kNew)) << "of a whole turn";
}

TEST(GyroCheck, DoesNotBelieveTurnsThatTheGyroWouldHaveSeen) {
  GyroCheck check;
  check.move(radians(5.0), 1.0);
  EXPECT_FALSE(check.believes(radians(1.5), kNew));
  EXPECT_FALSE(check.believes(radians(-1.5), kNew));
}

TEST(GyroCheck, AllowsForASweepThatIsALittleOlderThanTheMotionOfATurningRobot) {
  GyroCheck check;
  check.move(radians(1.5), 0.05);
  EXPECT_TRUE(check.believes(radians(1.5), kNew));
  check.move(0.0, 0.05);
  EXPECT_FALSE(check.believes(radians(1.5), kNew)) << "it stands";
}

TEST(GyroCheck, SumsUpSmallTurnsUntilTheWhileIsOver) {
  GyroCheck check;
  int believed = 0;
  for (; believed < 100 && check.believes(radians(0.3), kNew); ++believed) {
    check.corrected(radians(0.3));
    check.move(0.0, 0.2);
  }
  EXPECT_GT(believed, 0);
  EXPECT_LT(believed, 10);
  DeadReckoning dead_reckoning({}, {});
  check.conclude(dead_reckoning);
  EXPECT_TRUE(check.believes(radians(0.3), kNew));
}

/// A while of a robot that turns by 2 rad and that tracking turns by `missed_rad` more.
GyroCheck a_while(double missed_rad) {
  GyroCheck check;
  for (int i = 0; i < 50; ++i) {
    check.move(0.04, 0.25);
    check.corrected(missed_rad / 50.0);
  }
  return check;
}

TEST(GyroCheck, TeachesTheGyroWhatTrackingSaw) {
  DeadReckoning dead_reckoning({}, {});
  GyroCheck check = a_while(-0.024);
  EXPECT_TRUE(check.due());
  check.conclude(dead_reckoning);
  EXPECT_FALSE(check.due());
  EXPECT_NEAR(dead_reckoning.gyro().scale(), 0.012, 0.004);
}

TEST(GyroCheck, TeachesNothingWhenTrackingWasInterrupted) {
  DeadReckoning dead_reckoning({}, {});
  GyroCheck check = a_while(-0.024);
  check.interrupt();
  check.conclude(dead_reckoning);
  EXPECT_EQ(dead_reckoning.gyro().scale(), 0.0);
}

}  // namespace
}  // namespace cairn::agent
