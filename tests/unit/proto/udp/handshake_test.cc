#include <gmock/gmock.h>

#include "tests/unit/proto/udp/ends.h"

namespace cairn::proto {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

TEST_F(UdpEnds, AGreetingAndItsAnswerNeedOneRoundTrip) {
  ASSERT_TRUE(robot->send(greeting(), now));
  const auto up = take_up();
  ASSERT_THAT(up, SizeIs(1));
  arrive_up(up[0]);
  ASSERT_THAT(server_got, SizeIs(1));
  EXPECT_EQ(UdpPeer::of(server_got[0].peer).robot, "rover");
  EXPECT_EQ(server_got[0].bytes, greeting());
  ASSERT_TRUE(server->send({heard_last, {9, 9}}, now));
  const auto down = take_down();
  ASSERT_THAT(down, SizeIs(1));
  arrive_down(down[0].packet);
  ASSERT_THAT(robot_got, SizeIs(1));
  EXPECT_EQ(robot_got[0], (UdpBytes{9, 9}));
  EXPECT_TRUE(robot->send(UdpBytes{1}, now));
  const auto pose = take_up();
  ASSERT_THAT(pose, SizeIs(1));
  arrive_up(pose[0]);
  EXPECT_EQ(server_got.back().bytes, UdpBytes{1});
}

TEST_F(UdpEnds, ThatRoundTripCostsAFewHundredBytes) {
  constexpr std::size_t kIp = 28;
  (void)robot->send(greeting(), now);
  const auto up = take_up();
  arrive_up(up.at(0));
  (void)server->send({heard_last, UdpBytes(39)}, now);  // A Welcome.
  const auto down = take_down();
  EXPECT_LE(up.at(0).size() + down.at(0).packet.size() + 2 * kIp, 300U);
}

TEST_F(UdpEnds, TheAnswerDoesNotWaitLongForAFrameToRideAlong) {
  (void)robot->send(greeting(), now);
  settle();
  EXPECT_FALSE(robot->has_session());
  now += UdpServerEnd::kAnswerWait;
  settle();
  EXPECT_TRUE(robot->has_session());
}

TEST_F(UdpEnds, ARobotWithNothingToSayShowsItsKeysSoThatWaitingFramesCome) {
  (void)robot->send(greeting(), now);
  settle();
  now += UdpServerEnd::kAnswerWait;
  settle();
  for (std::uint8_t i = 0; i < 3; ++i) (void)server->send({heard_last, {i}}, now);
  settle();
  EXPECT_THAT(robot_got, IsEmpty()) << "the robot has not shown yet that it is there";
  now += UdpRobotEnd::kConfirmWait;
  settle();
  EXPECT_THAT(robot_got, SizeIs(3));
}

TEST_F(UdpEnds, OnlyAGreetingTravelsBeforeTheKeysAreAgreed) {
  const auto sent = robot->send(UdpBytes{1, 2, 3}, now);
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code, ErrorCode::unavailable);
  settle();
  EXPECT_THAT(server_got, IsEmpty());
  EXPECT_TRUE(robot->has_session());
  EXPECT_TRUE(both_ways());
}

TEST_F(UdpEnds, ALostSetUpComesAgainWithGrowingPatience) {
  (void)robot->send(greeting(), now);
  std::vector<Duration> waits;
  for (int i = 0; i < 12; ++i) {
    ASSERT_THAT(take_up(), SizeIs(1));
    const MonotonicTime due = robot->next_due(now);
    waits.push_back(due - now);
    now = due;
  }
  EXPECT_EQ(waits[0], UdpRobotEnd::kFirstWait);
  EXPECT_EQ(waits[1], UdpRobotEnd::kFirstWait * 3 / 2);
  EXPECT_EQ(*std::ranges::max_element(waits), UdpRobotEnd::kMostWait);
  now += UdpRobotEnd::kHopeful;
  (void)take_up();
  EXPECT_EQ(robot->next_due(now) - now, UdpRobotEnd::kMostWait) << "the wait already set";
  now = robot->next_due(now);
  (void)take_up();
  EXPECT_EQ(robot->next_due(now) - now, UdpRobotEnd::kPatientWait);
}

TEST_F(UdpEnds, ARepeatedSetUpIsAnsweredByTheSameBytes) {
  (void)robot->send(greeting(), now);
  const auto up = take_up();
  arrive_up(up.at(0));
  (void)server->send({heard_last, {5}}, now);
  const auto lost = take_down();
  now += seconds(1);
  const auto again = take_up();
  ASSERT_THAT(again, SizeIs(1));
  EXPECT_EQ(again[0], up[0]);
  arrive_up(again[0]);
  EXPECT_THAT(server_got, SizeIs(1)) << "the greeting is passed on once";
  const auto answer = take_down();
  ASSERT_THAT(answer, SizeIs(1));
  EXPECT_EQ(answer[0].packet, lost.at(0).packet);
  arrive_down(answer[0].packet);
  EXPECT_THAT(robot_got, testing::ElementsAre(UdpBytes{5}));
  EXPECT_TRUE(both_ways());
}

TEST_F(UdpEnds, AFirstPacketOfAStrangerCostsNoStateAndNoAnswer) {
  UdpRobotEnd stranger(Secret::random(), 5'000);
  (void)stranger.send(greeting(), now);
  arrive_up(*stranger.next_packet(now));
  for (std::size_t size : {0U, 1U, 2U, 9U, 10U, 50U, 120U, 1'400U}) {
    UdpBytes noise(size, 1);
    arrive_up(noise);
  }
  EXPECT_THAT(server_got, IsEmpty());
  EXPECT_THAT(take_down(), IsEmpty());
  EXPECT_EQ(server->sessions(), 0U);
  EXPECT_GE(server->refused_packets(), 9U);
}

TEST_F(UdpEnds, AForgedSetUpUnderAKnownKeysNameIsRefused) {
  (void)robot->send(greeting(), now);
  UdpBytes forged = take_up().at(0);
  forged.back() ^= 1U;
  arrive_up(forged);
  EXPECT_THAT(server_got, IsEmpty());
  EXPECT_EQ(server->sessions(), 0U);
}

TEST_F(UdpEnds, AForgedAnswerDoesNotSpoilTheGenuineOne) {
  (void)robot->send(greeting(), now);
  arrive_up(take_up().at(0));
  (void)server->send({heard_last, {5}}, now);
  const UdpBytes answer = take_down().at(0).packet;
  for (std::size_t byte = 0; byte < answer.size(); ++byte) {
    UdpBytes forged = answer;
    forged[byte] ^= 0x80U;
    arrive_down(forged);
    ASSERT_FALSE(robot->has_session()) << "byte " << byte;
  }
  arrive_down(answer);
  EXPECT_TRUE(robot->has_session());
}

TEST_F(UdpEnds, AnOldSetUpPlayedAgainOpensNothingAndDisturbsNobody) {
  (void)robot->send(greeting(), now);
  const UdpBytes recorded = take_up().at(0);
  arrive_up(recorded);
  settle();
  now += seconds(1);
  settle();
  connect();
  server_got.clear();
  arrive_up(recorded, address(66));
  EXPECT_THAT(server_got, IsEmpty());
  for (const auto& out : take_down()) {
    EXPECT_LT(out.packet.size(), recorded.size() / 2) << "no amplification";
    arrive_down(out.packet);
  }
  EXPECT_TRUE(both_ways());
}

TEST_F(UdpEnds, AnAnswerIsNeverMuchLongerThanWhatAskedForIt) {
  (void)robot->send(greeting(), now);
  const UdpBytes asked = take_up().at(0);
  arrive_up(asked);
  (void)server->send({heard_last, UdpBytes(kMaxFrameBytes, 3)}, now);
  const auto answer = take_down();
  ASSERT_THAT(answer, SizeIs(1));
  EXPECT_LE(answer[0].packet.size(), UdpServerEnd::kMostGrowth * asked.size());
  arrive_down(answer[0].packet);
  now += UdpRobotEnd::kConfirmWait;
  settle();
  EXPECT_THAT(robot_got, testing::ElementsAre(UdpBytes(kMaxFrameBytes, 3)));
}

TEST_F(UdpEnds, ASetUpThatARobotsClockMadeTooOldSucceedsOneRoundTripLater) {
  connect();
  robot = make_robot(5);  // Started anew, its clock back in the past.
  (void)robot->send(greeting(), now);
  settle();
  now += UdpServerEnd::kAnswerWait;
  settle();
  EXPECT_TRUE(robot->has_session());
  EXPECT_TRUE(both_ways());
}

TEST_F(UdpEnds, AForgedWordAboutStampsIsIgnored) {
  (void)robot->send(greeting(), now);
  const auto up = take_up();
  arrive_up(up.at(0));
  // Somebody who saw the packet does not know the key, nor what the robot wants to be called by.
  UdpBytes forged = encode(Stale{.robot_session = 1, .newest = ~std::uint64_t{0}, .proof = {}});
  arrive_down(forged);
  settle();
  now += UdpServerEnd::kAnswerWait;
  settle();
  EXPECT_TRUE(robot->has_session());
}

TEST_F(UdpEnds, AnswersToWhatProvesNothingAreBounded) {
  std::size_t answers = 0;
  for (int i = 0; i < 10'000; ++i) {
    UdpBytes noise = data_head(static_cast<std::uint32_t>(i), 1);
    noise.resize(kDataBytes);
    arrive_up(noise, address(i));
    for (const auto& out : take_down()) {
      EXPECT_LT(out.packet.size(), noise.size());
      ++answers;
    }
    now += milliseconds(1);
  }
  EXPECT_LE(answers, 50U + 10U * 50U);
}

TEST_F(UdpEnds, TwoRobotsWithOneKeyBothGetThrough) {
  connect();
  UdpRobotEnd twin(rover_key(), 9'000'000);
  const auto twin_at = address(2);
  std::vector<UdpBytes> twin_got;
  const auto settle_twin = [&] {
    while (auto packet = twin.next_packet(now)) arrive_up(*packet, twin_at);
    for (const auto& out : take_down()) {
      if (out.to == robot_at) arrive_down(out.packet);
      if (out.to != twin_at) continue;
      if (auto frame = twin.on_packet(out.packet, now)) twin_got.push_back(*frame);
    }
  };
  (void)twin.send(greeting(), now);
  settle_twin();
  EXPECT_EQ(server_got.back().bytes, greeting());
  (void)server->send({heard_last, {4, 0, 4}}, now);  // The layer above refuses it.
  settle_twin();
  EXPECT_THAT(twin_got, testing::ElementsAre(UdpBytes{4, 0, 4}));
  now += seconds(1);
  settle_twin();
  EXPECT_TRUE(both_ways()) << "the first one goes on";
}

TEST_F(UdpEnds, WhatIsMeantForAnAgentNeverReachesItsTwin) {
  connect();
  const std::string first = heard_last;
  UdpRobotEnd twin(rover_key(), 9'000'000);
  const auto twin_at = address(2);
  (void)twin.send(greeting(), now);
  while (auto packet = twin.next_packet(now)) arrive_up(*packet, twin_at);
  ASSERT_NE(heard_last, first);
  ASSERT_TRUE(server->send({first, {7}}, now));
  for (const auto& out : take_down()) {
    EXPECT_EQ(out.to, robot_at);
    arrive_down(out.packet);
  }
  EXPECT_THAT(robot_got, testing::ElementsAre(UdpBytes{7}));
}

}  // namespace
}  // namespace cairn::proto
