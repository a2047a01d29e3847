#include <gmock/gmock.h>

#include <chrono>
#include <set>

#include "proto/udp/robot_carrier.h"
#include "proto/udp/server_carrier.h"
#include "tests/unit/proto/udp/ends.h"

namespace cairn::proto {
namespace {

using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

UdpBytes pattern(std::size_t size) {
  UdpBytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(7 * i + 1);
  return bytes;
}

/// Real sockets on loopback, ports as the system gives them; both ends in this thread.
class UdpCarrier : public testing::Test {
 protected:
  std::unique_ptr<UdpServerCarrier> server = make_server(0);
  std::unique_ptr<UdpRobotCarrier> robot = make_robot();

  static std::unique_ptr<UdpServerCarrier> make_server(std::uint16_t port) {
    auto made = UdpServerCarrier::create({"127.0.0.1", port}, {{"rover", rover_key()}});
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    return std::move(made).value();
  }
  std::unique_ptr<UdpRobotCarrier> make_robot(const Secret& key = rover_key()) const {
    auto made = UdpRobotCarrier::create({"127.0.0.1", server->port()}, key);
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    return std::move(made).value();
  }
  static std::optional<Datagram> next(Carrier& carrier) {
    auto frame = carrier.receive(std::chrono::milliseconds(10));
    EXPECT_TRUE(frame);
    return frame ? *frame : std::nullopt;
  }
  /// Robot → server → robot.
  bool echoes(const UdpBytes& frame) {
    const auto end = Clock::now() + std::chrono::seconds(5);
    while (Clock::now() < end) {
      (void)robot->send({"", frame});
      if (const auto up = next(*server); up && up->bytes == frame) (void)server->send(*up);
      if (const auto down = next(*robot); down && down->bytes == frame) return true;
    }
    return false;
  }
};

TEST_F(UdpCarrier, CarriesTheSmallestAndTheLargestFrameBothWays) {
  EXPECT_TRUE(echoes({0}));
  EXPECT_TRUE(echoes(pattern(kMaxFrameBytes)));
}

TEST_F(UdpCarrier, NamesFramesAfterTheKeysRobot) {
  ASSERT_TRUE(robot->send({"", greeting()}));
  const auto up = next(*server);
  ASSERT_TRUE(up);
  EXPECT_EQ(server->proven_robot(up->peer), "rover");
}

TEST_F(UdpCarrier, FindsARestartedServerAndARestartedRobot) {
  ASSERT_TRUE(echoes({1}));
  const std::uint16_t port = server->port();
  server.reset();
  server = make_server(port);
  EXPECT_TRUE(echoes({2}));
  robot = make_robot();
  EXPECT_TRUE(echoes({3}));
}

TEST_F(UdpCarrier, RefusesFramesThatAreTooLongOrEmpty) {
  for (const std::size_t size : {std::size_t{0}, kMaxFrameBytes + 1}) {
    for (Carrier* carrier :
         {static_cast<Carrier*>(robot.get()), static_cast<Carrier*>(server.get())}) {
      const auto sent = carrier->send({"rover", UdpBytes(size)});
      ASSERT_FALSE(sent);
      EXPECT_EQ(sent.error().code, ErrorCode::invalid_argument);
    }
  }
}

TEST_F(UdpCarrier, SaysThatARobotHasNoSessionYet) {
  const auto sent = server->send({"rover", {1}});
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, ErrorCode::unavailable);
}

TEST_F(UdpCarrier, GivesAStrangerNothing) {
  const auto stranger = make_robot(Secret::random());
  for (int i = 0; i < 5; ++i) {
    (void)stranger->send({"", greeting()});
    EXPECT_FALSE(next(*server));
    EXPECT_FALSE(next(*stranger));
  }
}

TEST_F(UdpCarrier, WaitsNoLongerThanItsTimeout) {
  const auto start = Clock::now();
  ASSERT_TRUE(server->receive(std::chrono::milliseconds(50)));
  EXPECT_GE(Clock::now() - start, std::chrono::milliseconds(50));
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(1));
}

TEST_F(UdpCarrier, RefusesATakenPortInOneClearLine) {
  const auto second = UdpServerCarrier::create({"127.0.0.1", server->port()}, {});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::conflict);
  EXPECT_THAT(second.error().message, HasSubstr("is taken"));
}

TEST_F(UdpCarrier, SaysWhichHostItCannotFind) {
  const auto made = UdpRobotCarrier::create({"no-such-host.invalid", 9}, rover_key());
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("no-such-host.invalid"));
}

TEST_F(UdpCarrier, LosesNothingOfABurstThatItsBufferHolds) {
  ASSERT_TRUE(echoes({1}));
  constexpr std::uint32_t kFrames = 128;
  for (std::uint32_t i = 0; i < kFrames; ++i) {
    UdpBytes frame(400);
    frame[0] = static_cast<std::uint8_t>(i);
    frame[1] = static_cast<std::uint8_t>(i >> 8U);
    ASSERT_TRUE(robot->send({"", frame}));
  }
  std::set<UdpBytes> distinct;
  while (const auto frame = next(*server)) distinct.insert(frame->bytes);
  EXPECT_EQ(distinct.size(), kFrames);
}

}  // namespace
}  // namespace cairn::proto
