#include "client/cli/format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cairn::cli {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

TEST(AgeText, GrowsCoarserWithAge) {
  EXPECT_EQ(age_text(0.44), "0.4 s");
  EXPECT_EQ(age_text(59.6), "60 s");
  EXPECT_EQ(age_text(185), "3 min 05 s");
  EXPECT_EQ(age_text(7800), "2 h 10 min");
  EXPECT_EQ(age_text(4 * 86400 + 3 * 3600), "4 d 3 h");
  EXPECT_EQ(age_text(-1), "?");
}

TEST(BytesText, HasThreeDigits) {
  EXPECT_EQ(bytes_text(812), "812 B");
  EXPECT_EQ(bytes_text(3400), "3.40 kB");
  EXPECT_EQ(bytes_text(999'600), "1.00 MB");
  EXPECT_EQ(bytes_text(123'456'789), "123 MB");
}

TEST(TableText, AlignsItsColumns) {
  EXPECT_EQ(table_text({{"A", "B"}, {"long", "x"}}), "A     B\nlong  x\n");
}

TEST(StatusText, SaysHowOldEachFactIs) {
  api::RobotJson robot;
  robot.id = "r1";
  robot.pose_age_s = 75;
  robot.link.silence_s = 75;
  const auto text = status_text({"0.1.0", 60, {}, {robot}});
  EXPECT_THAT(text, HasSubstr("75 s ago"));
  EXPECT_THAT(text, HasSubstr("LOST for 75 s"));
  EXPECT_THAT(text, HasSubstr("no sites yet"));
}

TEST(LinkText, GivesTheRateBetweenTwoLooks) {
  api::RobotJson robot;
  robot.id = "r1";
  robot.link.connected = true;
  const api::StatusReply before{"0.1.0", 10, {}, {robot}};
  robot.link.bytes_up = 1000;
  robot.link.up.map_bytes = 750;
  robot.link.frames_lost = 1234;
  robot.link.loss_up = 0.21;
  const auto text = link_text(before, {"0.1.0", 12, {}, {robot}});
  EXPECT_THAT(text, HasSubstr("4.00"));
  EXPECT_THAT(text, HasSubstr("3.00"));
  EXPECT_THAT(text, HasSubstr("21 %"));
  EXPECT_THAT(text, HasSubstr("1,234 frames"));
}

TEST(LinkText, TellsHowLongTheRestWillTakeAtTheLatestPace) {
  api::RobotJson robot;
  robot.id = "r1";
  robot.link.backlog_blocks = 90;
  const api::StatusReply before{"0.1.0", 10, {}, {robot}};
  robot.link.backlog_blocks = 60;
  EXPECT_THAT(link_text(before, {"0.1.0", 12, {}, {robot}}), HasSubstr("in 4.0 s"));
  robot.link.backlog_blocks = 0;
  EXPECT_THAT(link_text(before, {"0.1.0", 12, {}, {robot}}), HasSubstr("now"));
}

TEST(LinkText, TellsWhatWaitsOnTheRobotsDiskAndWhatWentThere) {
  api::RobotJson robot;
  robot.id = "r1";
  const auto text = [&] {
    return link_text({"0.1.0", 10, {}, {robot}}, {"0.1.0", 12, {}, {robot}});
  };
  EXPECT_THAT(text(), Not(HasSubstr("submaps")));
  robot.link.spool = api::SpoolJson{"ok", 12, 3'000'000, 0, 0};
  EXPECT_THAT(text(), HasSubstr("12 submaps, 3.00 MB"));
  EXPECT_THAT(text(), Not(AnyOf(HasSubstr("THINNED"), HasSubstr("DROPPED"), HasSubstr("FAILED"))));
  robot.link.spool = api::SpoolJson{"failed", 12, 3'000'000, 5, 2};
  EXPECT_THAT(text(), HasSubstr("5 THINNED, 2 DROPPED, DISK FAILED"));
}

TEST(PlanText, GivesTheReasonWhenThereIsNoWay) {
  EXPECT_EQ(plan_text({"none", "the goal is unknown", 0, 0, 1, 0, {}}),
            "no way: the goal is unknown\n");
}

}  // namespace
}  // namespace cairn::cli
