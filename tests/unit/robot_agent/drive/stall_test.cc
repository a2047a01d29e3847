#include "robot_agent/drive/stall.h"

#include <gtest/gtest.h>

namespace cairn::agent {
namespace {

/// Whether it was found held within ten seconds of steps of 50 ms.
bool held(const DriveCommand& command, double moves_m_s, double turns_rad_s) {
  Stall stall;
  bool found = false;
  for (int i = 0; i < 200; ++i) {
    const double s = 0.05 * i;
    const Pose pose{.x_m = moves_m_s * s, .yaw_rad = turns_rad_s * s};
    found = stall.step(pose, command, MonotonicTime{std::chrono::milliseconds(50 * i)}) || found;
  }
  return found;
}

TEST(Stall, SeesThatTheRobotDoesNotGetOn) {
  EXPECT_TRUE(held({0.3, 0.0}, 0.0, 0.0));
  EXPECT_TRUE(held({0.0, 0.5}, 0.0, 0.0));
  EXPECT_TRUE(held({-0.2, 0.0}, 0.001, 0.001));
}

TEST(Stall, LeavesAloneWhoMovesOrStandsAsTold) {
  EXPECT_FALSE(held({0.3, 0.0}, 0.28, 0.0));
  EXPECT_FALSE(held({0.03, 0.0}, 0.025, 0.0));
  EXPECT_FALSE(held({0.0, 0.5}, 0.0, 0.5));
  EXPECT_FALSE(held({0.0, 0.0}, 0.0, 0.0));
}

}  // namespace
}  // namespace cairn::agent
