#include <gmock/gmock.h>

#include "tests/unit/proto/udp/ends.h"

namespace cairn::proto {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

TEST_F(UdpEnds, ARestartedServerIsFoundAgainByTheNextFrame) {
  connect();
  server = std::make_unique<UdpServerEnd>(keys);
  now += seconds(5);
  (void)robot->send(UdpBytes{1}, now);
  settle();
  EXPECT_TRUE(both_ways());
}

TEST_F(UdpEnds, ARestartedRobotReplacesItsOldSession) {
  connect();
  robot = make_robot(2'000);
  robot_at = address(1, 4001);
  connect();
  EXPECT_TRUE(both_ways());
}

TEST_F(UdpEnds, SessionsOfARobotThatStartsOverAndOverStayBounded) {
  for (std::uint64_t i = 0; i < 50; ++i) {
    robot = make_robot(2'000 + i);
    connect();
  }
  EXPECT_LE(server->sessions(), UdpServerEnd::kMaxSessions + 1);
}

TEST_F(UdpEnds, OldSessionsGoWhenANewOneIsThereAndTheyWereSilent) {
  connect();
  now += UdpServerEnd::kLinger + seconds(1);
  robot = make_robot(2'000);
  connect();
  EXPECT_EQ(server->sessions(), 1U);
}

TEST_F(UdpEnds, ARobotIsFollowedToItsNewAddress) {
  connect();
  robot_at = address(9, 1234);
  EXPECT_TRUE(both_ways());
}

TEST_F(UdpEnds, ACopyFromElsewhereDoesNotMoveARobot) {
  connect();
  (void)robot->send(UdpBytes{1}, now);
  const UdpBytes held_back = take_up().at(0);
  (void)robot->send(UdpBytes{2}, now);
  settle();
  arrive_up(held_back, address(66));  // Genuine, but older than what came from the robot itself.
  (void)server->send({heard_last, {3}}, now);
  EXPECT_EQ(take_down().at(0).to, robot_at);
  arrive_up(held_back, address(66));
  EXPECT_EQ(server_got.back().bytes, UdpBytes{1}) << "and counts once";
}

TEST_F(UdpEnds, AFalseUnknownSessionBreaksNothing) {
  connect();
  (void)robot->send(UdpBytes{1}, now);
  const auto up = take_up();
  const std::uint32_t name = *named_session(up.at(0));
  arrive_up(up[0]);
  int set_ups = 0;
  for (int i = 0; i < 600; ++i) {  // A minute of lies, ten a second.
    arrive_down(unknown_packet(name));
    for (const UdpBytes& packet : take_up()) {
      if (packet_type(packet) == PacketType::first) ++set_ups;
    }
    now += milliseconds(100);
  }
  EXPECT_LE(set_ups, 30) << "an attempt is repeated with its usual patience";
  EXPECT_TRUE(both_ways()) << "the session is still there";
}

TEST_F(UdpEnds, AnEmptyUnknownSessionOfAStrangerIsIgnored) {
  connect();
  arrive_down(unknown_packet(12345));
  EXPECT_THAT(take_up(), IsEmpty());
}

TEST_F(UdpEnds, AGreetingAfterSilenceSetsUpAnewAndTheOldSessionLivesUntilThen) {
  connect();
  now += UdpRobotEnd::kQuiet + milliseconds(1);
  (void)robot->send(greeting(2), now);
  const auto up = take_up();
  ASSERT_THAT(up, SizeIs(1));
  EXPECT_EQ(packet_type(up[0]), PacketType::first);
  EXPECT_TRUE(both_ways());
  arrive_up(up[0]);
  EXPECT_EQ(server_got.back().bytes, greeting(2));
  (void)server->send({heard_last, {8}}, now);
  settle();
  EXPECT_EQ(robot_got.back(), UdpBytes{8});
  EXPECT_TRUE(both_ways());
}

TEST_F(UdpEnds, AGreetingInALiveSessionTravelsInIt) {
  connect();
  (void)robot->send(greeting(2), now);
  const auto up = take_up();
  ASSERT_THAT(up, SizeIs(1));
  EXPECT_TRUE(is_data(up[0]));
}

TEST_F(UdpEnds, KeysAreRenewedWithoutAGap) {
  connect();
  (void)robot->send(UdpBytes{1}, now);
  const std::uint32_t old_name = *named_session(take_up().at(0));
  now += UdpRobotEnd::kMaxAge;
  settle();
  (void)robot->send(UdpBytes{2}, now);
  const UdpBytes sealed = take_up().at(0);
  EXPECT_NE(named_session(sealed), old_name);
  arrive_up(sealed);
  EXPECT_EQ(server_got.back().bytes, UdpBytes{2});
  EXPECT_TRUE(both_ways());
}

TEST_F(UdpEnds, FramesUnderWayDuringARenewalStillArrive) {
  connect();
  now += UdpRobotEnd::kMaxAge - seconds(10);
  ASSERT_TRUE(both_ways());
  (void)robot->send(UdpBytes{1}, now);
  const UdpBytes late_up = take_up().at(0);
  (void)server->send({heard_last, {2}}, now);
  const UdpBytes late_down = take_down().at(0).packet;
  now += seconds(10);
  settle();
  ASSERT_TRUE(both_ways());
  arrive_up(late_up);
  arrive_down(late_down);
  ASSERT_THAT(server_got, SizeIs(1));
  EXPECT_EQ(server_got[0].bytes, UdpBytes{1});
  ASSERT_THAT(robot_got, SizeIs(1));
  EXPECT_EQ(robot_got[0], UdpBytes{2});
}

/// Whatever is lost, doubled, reordered or restarted: in the end frames go both ways.
TEST_F(UdpEnds, ComesBackFromAnyMischief) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    const auto chance = [&](double p) { return std::bernoulli_distribution(p)(random); };
    std::uint64_t stamp = 10'000 * seed;
    std::vector<UdpBytes> up;
    std::vector<UdpServerEnd::Outgoing> down;
    for (int i = 0; i < 300; ++i) {
      now += milliseconds(50);
      if (chance(0.01)) server = std::make_unique<UdpServerEnd>(keys);
      if (chance(0.01)) robot = make_robot(chance(0.5) ? stamp += 50 : 1);
      if (chance(0.02)) robot_at = address(static_cast<int>(random() % 100));
      (void)robot->send(chance(0.3) ? greeting(static_cast<std::uint32_t>(i)) : UdpBytes{1}, now);
      (void)server->send({heard_last, {2}}, now);
      for (auto& packet : take_up()) up.push_back(std::move(packet));
      for (auto& out : take_down()) down.push_back(std::move(out));
      std::ranges::shuffle(up, random);
      std::ranges::shuffle(down, random);
      while (!up.empty() && chance(0.7)) {
        if (!chance(0.3)) arrive_up(up.back());
        if (!chance(0.1)) up.pop_back();
      }
      while (!down.empty() && chance(0.7)) {
        if (!chance(0.3) && down.back().to == robot_at) arrive_down(down.back().packet);
        if (!chance(0.1)) down.pop_back();
      }
    }
    for (int i = 0; i < 100; ++i) {
      now += milliseconds(200);
      (void)robot->send(UdpBytes{1}, now);
      settle();
    }
    ASSERT_TRUE(both_ways()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace cairn::proto
