#include "robot_agent/pipeline/gyro_check.h"

#include <gtest/gtest.h>

#include "core/common/angle.h"

namespace cairn::agent {
namespace {

TEST(GyroCheck, BelievesWhatTheGyroMayHaveMissed) {
  GyroCheck check{DeadReckoningConfig{}};
  EXPECT_TRUE(check.believes(radians(0.2))) << "a match's own error";
  check.move(radians(360.0), 20.0);
  EXPECT_TRUE(check.believes(radians(-5.0))) << "of a whole turn";
}

TEST(GyroCheck, DoesNotBelieveTurnsThatTheGyroWouldHaveSeen) {
  GyroCheck check{DeadReckoningConfig{}};
  check.move(radians(5.0), 1.0);
  EXPECT_FALSE(check.believes(radians(1.5)));
  EXPECT_FALSE(check.believes(radians(-1.5)));
}

TEST(GyroCheck, AllowsForASweepThatIsALittleOlderThanTheMotionOfATurningRobot) {
  GyroCheck check{DeadReckoningConfig{}};
  check.move(radians(1.5), 0.05);
  EXPECT_TRUE(check.believes(radians(1.5)));
  check.move(0.0, 0.05);
  EXPECT_FALSE(check.believes(radians(1.5))) << "it stands";
}

TEST(GyroCheck, SumsUpSmallTurnsUntilItBeginsAnew) {
  GyroCheck check{DeadReckoningConfig{}};
  int believed = 0;
  for (; believed < 100 && check.believes(radians(0.3)); ++believed) {
    check.corrected(radians(0.3));
    check.move(0.0, 0.2);
  }
  EXPECT_GT(believed, 0);
  EXPECT_LT(believed, 10);
  check.restart();
  EXPECT_TRUE(check.believes(radians(0.3)));
}

}  // namespace
}  // namespace cairn::agent
