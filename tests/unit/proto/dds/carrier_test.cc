#include <gmock/gmock.h>

#include <set>

#include "proto/dds/robot_carrier.h"
#include "proto/dds/server_carrier.h"
#include "tests/support/dds_flood.h"
#include "tests/unit/proto/dds/peers.h"

namespace cairn::proto {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

Bytes pattern(std::size_t size, std::uint8_t start) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(start + i * 7);
  return bytes;
}

class DdsCarrier : public testing::Test {
 protected:
  std::unique_ptr<DdsServerCarrier> make_server() {
    auto made = DdsServerCarrier::create({"127.0.0.1", domain_.number()});
    EXPECT_TRUE(made) << made.error().message;
    return std::move(made).value();
  }
  std::unique_ptr<DdsRobotCarrier> make_robot(const std::string& id) {
    auto made = DdsRobotCarrier::create({"127.0.0.1", domain_.number()}, id);
    EXPECT_TRUE(made) << made.error().message;
    return std::move(made).value();
  }

  TestDomain domain_;
};

TEST_F(DdsCarrier, CarriesTheSmallestAndTheLargestFrameFromServerToRobotAndBack) {
  const auto server = make_server();
  const EchoProcess robot({"robot", domain_.url(), "rover-1"});
  EXPECT_TRUE(echoes(*server, {"rover-1", {0}}));
  EXPECT_TRUE(echoes(*server, {"rover-1", pattern(kMaxFrameBytes, 3)}));
}

TEST_F(DdsCarrier, CarriesTheSmallestAndTheLargestFrameFromRobotToServerAndBack) {
  const auto robot = make_robot("rover-1");
  const EchoProcess server({"server", domain_.url()});
  EXPECT_TRUE(echoes(*robot, {"", {0}}));
  EXPECT_TRUE(echoes(*robot, {"", pattern(kMaxFrameBytes, 5)}));
}

TEST_F(DdsCarrier, NamesEachFrameAfterItsRobotAndKeepsRobotsApart) {
  const auto server = make_server();
  const EchoProcess a({"robot", domain_.url(), "rover-a"});
  const EchoProcess b({"robot", domain_.url(), "rover-b"});
  ASSERT_TRUE(echoes(*server, {"rover-a", bytes_of("for a")}));
  ASSERT_TRUE(echoes(*server, {"rover-b", bytes_of("for b")}));
  // Both are matched now, and return whatever they hear: they must hear only what is theirs.
  const std::set<Bytes> belongs_to_a{bytes_of("for a"), bytes_of("rover-a")};
  const std::set<Bytes> belongs_to_b{bytes_of("for b"), bytes_of("rover-b")};
  int from_a = 0;
  int from_b = 0;
  for (int i = 0; i < 200 && (from_a < 10 || from_b < 10); ++i) {
    (void)server->send(
        {i % 2 == 0 ? "rover-a" : "rover-b", bytes_of(i % 2 == 0 ? "for a" : "for b")});
    const auto frame = server->receive(100ms);
    ASSERT_TRUE(frame);
    if (!frame->has_value()) continue;
    const bool is_a = (*frame)->peer == "rover-a";
    ASSERT_TRUE(is_a || (*frame)->peer == "rover-b") << (*frame)->peer;
    EXPECT_TRUE((is_a ? belongs_to_a : belongs_to_b).contains((*frame)->bytes));
    ++(is_a ? from_a : from_b);
  }
  EXPECT_GE(from_a, 10);
  EXPECT_GE(from_b, 10);
}

TEST_F(DdsCarrier, SaysThatNobodyIsThereYet) {
  const auto server = make_server();
  const auto to_robot = server->send({"rover-1", {1}});
  ASSERT_FALSE(to_robot);
  EXPECT_EQ(to_robot.error().code, ErrorCode::unavailable);
  const auto nothing = server->receive(0ms);
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(nothing->has_value());
}

TEST_F(DdsCarrier, TellsARobotThatNoServerIsThereYet) {
  const auto robot = make_robot("rover-1");
  const auto sent = robot->send({"", {1}});
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, ErrorCode::unavailable);
}

TEST_F(DdsCarrier, RefusesFramesThatAreTooLongOrEmpty) {
  const auto robot = make_robot("rover-1");
  for (const std::size_t size : {std::size_t{0}, kMaxFrameBytes + 1}) {
    const auto sent = robot->send({"", Bytes(size)});
    ASSERT_FALSE(sent);
    EXPECT_EQ(sent.error().code, ErrorCode::invalid_argument);
  }
}

TEST_F(DdsCarrier, RefusesABadRobotId) {
  const auto made = DdsRobotCarrier::create({"127.0.0.1", domain_.number()}, "*");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::invalid_argument);
}

TEST_F(DdsCarrier, WaitsNoLongerThanItsTimeout) {
  const auto server = make_server();
  const auto start = Clock::now();
  ASSERT_TRUE(server->receive(100ms));
  const auto waited = Clock::now() - start;
  EXPECT_GE(waited, 100ms);
  EXPECT_LT(waited, 1s);
}

TEST_F(DdsCarrier, RefusesASecondServerInOneClearLine) {
  const auto robot_meets = [&] {
    const auto robot = make_robot("rover-1");
    return echoes(*robot, {"", {1}});
  };
  const EchoProcess server({"server", domain_.url()});
  ASSERT_TRUE(robot_meets());
  testing::internal::CaptureStderr();
  const auto second = DdsServerCarrier::create({"127.0.0.1", domain_.number()});
  const std::string noise = testing::internal::GetCapturedStderr();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::conflict);
  EXPECT_THAT(second.error().message, HasSubstr("DDS domain " + std::to_string(domain_.number()) +
                                                " is already served on this machine"));
  EXPECT_EQ(noise, "");
}

TEST_F(DdsCarrier, RefusesASecondCarrierOfTheSameDomainInOneProcess) {
  const auto server = make_server();
  const auto second = DdsRobotCarrier::create({"127.0.0.1", domain_.number()}, "rover-1");
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::conflict);
}

TEST_F(DdsCarrier, SaysWhichHostItCannotFind) {
  const auto made = DdsRobotCarrier::create({"no-such-host.invalid", domain_.number()}, "rover-1");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::unavailable);
  EXPECT_THAT(made.error().message, HasSubstr("no-such-host.invalid"));
}

TEST_F(DdsCarrier, DropsFramesFromWritersThatAreNoRobots) {
  const auto server = make_server();
  std::vector<std::string> heard;
  const auto receive = [&] {
    const auto frame = server->receive(200ms);
    if (frame && frame->has_value()) heard.push_back((*frame)->peer);
  };
  const auto participant =
      DdsEntity::create(dds_create_participant(domain_.number(), nullptr, nullptr), "participant");
  const auto topic = create_frame_topic(participant->get(), kUpTopic);
  for (const char* partition : {"Not A Robot", "*", "", "rover-1"}) {
    auto writer = FrameTopicWriter::create(participant->get(), topic->get(), partition);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->write(Bytes{1}));
    receive();
  }
  EXPECT_THAT(heard, testing::ElementsAre("rover-1"));
}

std::size_t count_flood(Carrier& carrier, const std::string& peer) {
  std::set<Bytes> distinct;
  const auto is_flood = [](const Datagram& frame) { return is_flood_frame(frame.bytes); };
  auto first = exchange(
      carrier, {peer, bytes_of("warm up")},
      [&](const Datagram& got) { return got.bytes == bytes_of("warm up"); }, 8s);
  if (!first) return 0;
  EXPECT_TRUE(carrier.send({peer, bytes_of(kFloodRequest)}));
  for (auto quiet_since = Clock::now();
       distinct.size() < kFloodFrames && Clock::now() - quiet_since < 8s;) {
    auto frame = carrier.receive(100ms);
    if (!frame || !frame->has_value() || !is_flood(**frame)) continue;
    distinct.insert(std::move((*frame)->bytes));
    quiet_since = Clock::now();
  }
  return distinct.size();
}

TEST_F(DdsCarrier, LosesNothingOfABurstAtFullSpeedFromRobotToServer) {
  const auto server = make_server();
  const EchoProcess robot({"robot", domain_.url(), "rover-1"});
  const std::size_t arrived = count_flood(*server, "rover-1");
  EXPECT_EQ(arrived, kFloodFrames);
}

TEST_F(DdsCarrier, LosesNothingOfABurstAtFullSpeedFromServerToRobot) {
  const auto robot = make_robot("rover-1");
  const EchoProcess server({"server", domain_.url()});
  const std::size_t arrived = count_flood(*robot, "");
  EXPECT_EQ(arrived, kFloodFrames);
}

}  // namespace
}  // namespace cairn::proto
