#include "proto/json/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace cairn::api {
namespace {

using nlohmann::json;
using testing::HasSubstr;

template <class T>
std::string fault_of(const json& text) {
  const auto message = from_json<T>(text);
  return message ? "none" : message.error().message;
}

RobotJson some_robot() {
  RobotJson robot;
  robot.id = "r1";
  robot.site = "yard";
  robot.x_m = 1.5;
  robot.yaw_rad = -0.5;
  robot.drive = "driving";
  robot.localization = "unsure";
  robot.link = {true, 0.2, 0.11, 1234, 567, 8, 9, 10};
  robot.link.spool = SpoolJson{"failed", 12, 3'456'789, 5, 2};
  robot.command = CommandJson{7, "goto", "accepted", "", {3.0, -4.0}, 5.5, 2, {{0, 0}, {3, -4}}};
  return robot;
}

template <class T>
void expect_round_trip(const T& message) {
  const json once = message;
  const auto read = from_json<T>(once);
  ASSERT_TRUE(read) << read.error().message << " in " << once;
  EXPECT_EQ(json(*read), once);
}

TEST(Messages, AreReadBackAsTheyWereWritten) {
  StatusReply status{"0.1.0", 12.5, {{"yard", 125, 4, 3, 2, 1, 9, 8, 7}}, {some_robot()}};
  expect_round_trip(status);
  expect_round_trip(FoundRequest{"yard", 50});
  expect_round_trip(GotoRequest{"r1", -3.0, 2.5, "blocked", "continue", 60.0, true});
  expect_round_trip(StopRequest{});
  expect_round_trip(CommandReply{7, "r1", "complete", "", 12.0, 13.0, {{1, 2}}});
  expect_round_trip(PlanRequestJson{"yard", {0, 0}, {1, 1}, "allowed", true});
  expect_round_trip(PlanReply{"partial", "a wall", 1.0, 2.0, 3, 0.01, {{1, 2}, {3, 4}}});
  expect_round_trip(MapRequest{"yard"});
  expect_round_trip(WatchRequest{500});
  expect_round_trip(Empty{});
  expect_round_trip(MapReply{"yard", 125, 5, 2, 100, 120, {some_robot()}, {{{0, 0}, {1, 1}}, {}}});
}

TEST(Messages, KeepWholeNumbersExact) {
  SiteJson site{"yard", 125, 0, 0, 0, 0, 0, 0, 0};
  site.map_version = std::numeric_limits<std::uint64_t>::max();
  const auto read = from_json<SiteJson>(json::parse(json(site).dump()));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->map_version, site.map_version);
}

TEST(Messages, RequestsFillInWhatHasADefault) {
  const auto read = from_json<GotoRequest>(json{{"x_m", 1}, {"y_m", 2.5}});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->robot, std::nullopt);
  EXPECT_EQ(read->unknown, "allowed");
  EXPECT_EQ(read->expires_s, 600.0);
}

TEST(Messages, TasksComeBackAsTheyWereWritten) {
  GotoRequest go;
  go.x_m = 1.5;
  go.heading_rad = -1.0;
  go.then = {{2, 3, {}}, {-4, 5, 0.5}};
  go.loop = true;
  go.on_link_loss = "return";
  const auto read = from_json<GotoRequest>(json(go));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->then.size(), 2U);
  EXPECT_EQ(read->then[1].x_m, -4.0);
  EXPECT_EQ(read->heading_rad, -1.0);
  EXPECT_EQ(read->then[0].heading_rad, std::nullopt);
  EXPECT_EQ(read->then[1].heading_rad, 0.5);
  EXPECT_TRUE(read->loop);
  EXPECT_EQ(read->on_link_loss, "return");
  ExploreRequest explore;
  explore.area = AreaJson{-1, -2, 3, 4};
  EXPECT_EQ(from_json<ExploreRequest>(json(explore))->area->north_m, 4.0);
  EXPECT_EQ(from_json<ExploreRequest>(json::object())->on_link_loss, "return");
  EXPECT_EQ(from_json<ReturnRequest>(json::object())->expires_s, 600.0);
  EXPECT_EQ(fault_of<ExploreRequest>({{"area", {{"west_m", 0}}}}), "missing key \"area.south_m\"");
  RobotJson robot = some_robot();
  robot.task = TaskJson{3, "explore", "active", "", 4, 0, 0, 1, 60.0, 12.5};
  EXPECT_EQ(from_json<RobotJson>(json(robot))->task->eta_s, 12.5);
}

TEST(Messages, RefuseAnUnknownKeyByItsName) {
  EXPECT_THAT(fault_of<GotoRequest>({{"x_m", 1}, {"y_m", 2}, {"speed", 3}}),
              HasSubstr("unknown key \"speed\""));
  EXPECT_THAT(fault_of<Empty>({{"x", 1}}), HasSubstr("unknown key \"x\""));
  EXPECT_THAT(fault_of<PlanRequestJson>({{"from", {{"x_m", 0}, {"y_m", 0}, {"z_m", 0}}},
                                         {"to", {{"x_m", 0}, {"y_m", 0}}}}),
              HasSubstr("unknown key \"from.z_m\""));
}

TEST(Messages, RefuseAMissingKeyByItsName) {
  EXPECT_EQ(fault_of<GotoRequest>({{"x_m", 1}}), "missing key \"y_m\"");
  EXPECT_EQ(fault_of<PlanRequestJson>({{"from", {{"x_m", 0}}}, {"to", {{"x_m", 0}, {"y_m", 0}}}}),
            "missing key \"from.y_m\"");
}

TEST(Messages, RefuseAWrongTypeAndSayWhatIsExpected) {
  EXPECT_EQ(fault_of<GotoRequest>({{"x_m", "1"}, {"y_m", 2}}),
            "x_m: expected a number from -100000 to 100000");
  EXPECT_EQ(fault_of<GotoRequest>({{"x_m", 1}, {"y_m", 2}, {"allow_partial", 1}}),
            "allow_partial: expected true or false");
  EXPECT_EQ(fault_of<FoundRequest>({{"site", "a"}, {"cell_size_mm", 125.5}}),
            "cell_size_mm: expected a whole number from 10 to 2000");
  EXPECT_EQ(fault_of<StopRequest>({{"robot", nullptr}}),
            "robot: expected a name of 1 to 32 characters a-z, 0-9, _ and -");
  EXPECT_EQ(fault_of<StopRequest>(json::array()), "message: expected an object");
  EXPECT_EQ(fault_of<PlanRequestJson>({{"from", 1}, {"to", 2}}), "from: expected an object");
}

TEST(Messages, RefuseAbsurdNumbers) {
  for (const double x_m : {100'001.0, -100'001.0, 1e300, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(fault_of<GotoRequest>({{"x_m", x_m}, {"y_m", 0}}), HasSubstr("x_m: expected"));
  }
  for (const double heading_rad : {6.3, -7.0, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(fault_of<GotoRequest>({{"x_m", 1}, {"y_m", 0}, {"heading_rad", heading_rad}}),
                HasSubstr("heading_rad: expected a number from -6.28"));
    EXPECT_THAT(
        fault_of<GotoRequest>({{"x_m", 1},
                               {"y_m", 0},
                               {"then", {{{"x_m", 1}, {"y_m", 0}, {"heading_rad", heading_rad}}}}}),
        HasSubstr("then[0].heading_rad: expected"));
  }
  EXPECT_THAT(fault_of<WatchRequest>({{"period_ms", 99}}), HasSubstr("from 100 to 10000"));
  EXPECT_THAT(fault_of<WatchRequest>({{"period_ms", 18446744073709551615U}}),
              HasSubstr("from 100 to 10000"));
  EXPECT_THAT(fault_of<GotoRequest>({{"x_m", 1}, {"y_m", 2}, {"expires_s", 0.5}}),
              HasSubstr("expires_s: expected a number from 1 to 86400"));
}

TEST(Messages, RefuseATextThatIsNoneOfTheChoices) {
  EXPECT_EQ(fault_of<GotoRequest>({{"x_m", 1}, {"y_m", 2}, {"unknown", "maybe"}}),
            "unknown: expected one of \"blocked\", \"allowed\"");
}

TEST(Messages, RefuseNamesThatCouldBePaths) {
  for (const char* name : {"", "../etc", "Yard", "a b", "012345678901234567890123456789012"}) {
    EXPECT_THAT(fault_of<FoundRequest>({{"site", name}}), HasSubstr("site: expected a name"));
  }
}

TEST(Messages, NameTheElementOfAListThatIsWrong) {
  json status = StatusReply{"0.1.0", 1.0, {}, {some_robot(), some_robot()}};
  status["robots"][1]["link"]["silence_s"] = -1;
  EXPECT_EQ(fault_of<StatusReply>(status).substr(0, 26), "robots[1].link.silence_s: ");
}

}  // namespace
}  // namespace cairn::api
