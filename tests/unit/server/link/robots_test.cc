#include "server/link/robots.h"

#include <gtest/gtest.h>

namespace cairn::server {
namespace {

using std::chrono::seconds;

proto::PoseReport pose_at(std::uint64_t clock_ms, std::int32_t x_mm) {
  proto::PoseReport report;
  report.clock_ms = clock_ms;
  report.T_site_robot.x_mm = x_mm;
  return report;
}

TEST(Robot, IsWhereItsNewestPoseSays) {
  Robot robot;
  robot.take_pose(pose_at(1000, 500), seconds(1));
  robot.take_pose(pose_at(2000, 1500), seconds(2));
  EXPECT_EQ(robot.x_m(), 1.5);
  EXPECT_EQ(robot.pose_received, seconds(2));
}

TEST(Robot, IgnoresAPoseThatWasOvertaken) {
  Robot robot;
  robot.take_pose(pose_at(2000, 1500), seconds(1));
  robot.take_pose(pose_at(1000, 500), seconds(2));
  EXPECT_EQ(robot.x_m(), 1.5);
  EXPECT_EQ(robot.pose_received, seconds(1));
}

TEST(Robot, LeavesATrackOfPointsADecimetreApart) {
  Robot robot;
  for (int i = 0; i <= 100; ++i) {
    robot.take_pose(pose_at(static_cast<std::uint64_t>(i), 60 * i), seconds(i));
  }
  EXPECT_EQ(robot.track.size(), 51U);  // Every second one.
  EXPECT_EQ(robot.track.back().x_m, 6.0);
}

TEST(Robot, ForgetsTheOldestOfAnEndlessTrack) {
  Robot robot;
  for (std::size_t i = 0; i < Robot::kMaxTrack + 10; ++i) {
    robot.take_pose(pose_at(i, static_cast<std::int32_t>(200 * i)), seconds(i));
  }
  EXPECT_EQ(robot.track.size(), Robot::kMaxTrack);
  EXPECT_EQ(robot.track.front().x_m, 2.0);
}

}  // namespace
}  // namespace cairn::server
