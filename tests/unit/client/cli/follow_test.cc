#include "client/cli/follow.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/cli/options.h"

namespace cairn::cli {
namespace {

using testing::HasSubstr;

api::StatusReply status_with(const std::string& state, double uptime_s = 10.0,
                             std::uint64_t command = 7) {
  api::RobotJson robot;
  robot.id = "r1";
  robot.link = {true, 0.1, 0.1, 1500, 700, 0, 0, 0};
  robot.pose_age_s = 0.4;
  robot.command = api::CommandJson{command, "goto", state, "a wall", {}, 3.25, 1, {}};
  return {"0.1.0", uptime_s, {}, {robot}};
}

Follow follow() {
  auto before = status_with("arrived", 0.0, 3);
  before.robots[0].link.bytes_up = 500;
  return {before, "r1", 7};
}

TEST(Follow, ShowsPlaceWayAgeAndBytesSinceTheStart) {
  const auto step = follow().step(status_with("accepted"));
  EXPECT_FALSE(step.exit);
  EXPECT_THAT(step.line, HasSubstr("3.2 m to go"));
  EXPECT_THAT(step.line, HasSubstr("pose 0.4 s old"));
  EXPECT_THAT(step.line, HasSubstr("up 1.00 kB"));
}

TEST(Follow, ShowsTheHeadingThatIsAskedForAndTheOneItHas) {
  auto status = status_with("accepted");
  status.robots[0].yaw_rad = 0.5236;
  status.robots[0].command->heading_rad = 1.5708;
  EXPECT_THAT(follow().step(status).line, HasSubstr("3.2 m to go, heading 30 deg of 90 deg"));
  status.robots[0].command->state = "arrived";
  EXPECT_THAT(follow().step(status).line, HasSubstr(", heading 30 deg after"));
}

TEST(Follow, SucceedsOnlyOnArrival) {
  EXPECT_EQ(follow().step(status_with("arrived")).exit, kExitOk);
  for (const char* state : {"refused", "superseded", "stopped", "expired"}) {
    const auto step = follow().step(status_with(state));
    EXPECT_EQ(step.exit, kExitFailed);
    EXPECT_EQ(step.line, std::string(state) + ": a wall");
  }
}

TEST(Follow, IgnoresAnOlderCommandAndEndsOnANewerOne) {
  EXPECT_FALSE(follow().step(status_with("arrived", 10.0, 3)).exit);
  EXPECT_EQ(follow().step(status_with("accepted", 10.0, 8)).exit, kExitFailed);
}

TEST(Follow, EndsWhenBlockedForGood) {
  auto following = follow();
  EXPECT_FALSE(following.step(status_with("blocked", 10.0)).exit);
  EXPECT_FALSE(following.step(status_with("accepted", 20.0)).exit);
  EXPECT_FALSE(following.step(status_with("blocked", 30.0)).exit);
  EXPECT_FALSE(following.step(status_with("blocked", 59.0)).exit);
  EXPECT_EQ(following.step(status_with("blocked", 60.0)).exit, kExitFailed);
}

TEST(Follow, EndsWhenTheRobotIsGone) {
  EXPECT_EQ(follow().step({"0.1.0", 1.0, {}, {}}).exit, kExitFailed);
}

}  // namespace
}  // namespace cairn::cli
