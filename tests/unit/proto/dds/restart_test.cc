#include <gtest/gtest.h>

#include "proto/dds/robot_carrier.h"
#include "proto/dds/server_carrier.h"
#include "tests/unit/proto/dds/peers.h"

namespace cairn::proto {
namespace {

using namespace std::chrono_literals;

constexpr auto kFoundAgainWithin = 5s;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

TEST(DdsRestart, AServerFindsAKilledRobotAgainWhenItIsBack) {
  const TestDomain domain;
  auto server = DdsServerCarrier::create({"127.0.0.1", domain.number()});
  ASSERT_TRUE(server) << server.error().message;
  EchoProcess robot({"robot", domain.url(), "rover-1"});
  ASSERT_TRUE(echoes(**server, {"rover-1", bytes_of("before")}));
  robot.kill_now();
  const EchoProcess again({"robot", domain.url(), "rover-1"});
  const auto start = Clock::now();
  EXPECT_TRUE(echoes(**server, {"rover-1", bytes_of("after")}, kFoundAgainWithin));
  RecordProperty("seconds", std::to_string(seconds_since(start)));
}

TEST(DdsRestart, ARobotFindsAKilledServerAgainWhenItIsBack) {
  const TestDomain domain;
  auto robot = DdsRobotCarrier::create({"127.0.0.1", domain.number()}, "rover-1");
  ASSERT_TRUE(robot) << robot.error().message;
  EchoProcess server({"server", domain.url()});
  ASSERT_TRUE(echoes(**robot, {"", bytes_of("before")}));
  server.kill_now();
  const EchoProcess again({"server", domain.url()});
  const auto start = Clock::now();
  EXPECT_TRUE(echoes(**robot, {"", bytes_of("after")}, kFoundAgainWithin));
  RecordProperty("seconds", std::to_string(seconds_since(start)));
}

TEST(DdsRestart, ARobotMeetsAServerThatStartsLater) {
  const TestDomain domain;
  auto robot = DdsRobotCarrier::create({"127.0.0.1", domain.number()}, "rover-1");
  ASSERT_TRUE(robot) << robot.error().message;
  ASSERT_FALSE(echoes(**robot, {"", {1}}, 2s));
  const EchoProcess server({"server", domain.url()});
  EXPECT_TRUE(echoes(**robot, {"", {1}}, kFoundAgainWithin));
}

}  // namespace
}  // namespace cairn::proto
