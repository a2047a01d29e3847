#include "proto/sync/flight.h"

#include <gtest/gtest.h>

namespace cairn::proto {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Numbers = std::vector<std::uint32_t>;

class FlightTest : public ::testing::Test {
 protected:
  void send(int frames, MonotonicTime now = {}) {
    for (int i = 0; i < frames; ++i) {
      const std::uint32_t number = flight.next_number(out_of_reach);
      flight.sent(number, Flight::Load::evidence, {100, 100}, now);
    }
  }
  Flight flight;
  Numbers out_of_reach;
};

TEST_F(FlightTest, NumbersCountUpFromOne) {
  EXPECT_EQ(flight.next_number(out_of_reach), 1U);
  EXPECT_EQ(flight.next_number(out_of_reach), 2U);
}

TEST_F(FlightTest, AnAcknowledgedFrameIsNewsOnce) {
  send(3);
  EXPECT_EQ(flight.on_ack({2, 0}, milliseconds(100)).acked, (Numbers{1, 2}));
  EXPECT_TRUE(flight.on_ack({2, 0}, milliseconds(100)).acked.empty());
  EXPECT_EQ(*flight.round_trip().smoothed(), milliseconds(100));
}

TEST_F(FlightTest, AFrameIsLostWhenThreeNewerOnesWereAcknowledged) {
  send(5);
  EXPECT_TRUE(flight.on_ack({0, 0b11}, milliseconds(50)).lost.empty());     // 2, 3
  EXPECT_EQ(flight.on_ack({0, 0b111}, milliseconds(60)).lost, Numbers{1});  // 4
  EXPECT_TRUE(flight.on_ack({0, 0b1111}, milliseconds(70)).lost.empty());
}

TEST_F(FlightTest, AFrameJudgedLostTooEarlyIsStillAcknowledged) {
  send(4);
  EXPECT_EQ(flight.on_ack({0, 0b111}, milliseconds(60)).lost, Numbers{1});
  EXPECT_EQ(flight.on_ack({4, 0}, milliseconds(90)).acked, Numbers{1});
}

TEST_F(FlightTest, SilenceLosesFramesWithGrowingPatience) {
  send(1);
  const MonotonicTime first = RoundTrip::kFirstTimeout;
  EXPECT_EQ(*flight.due(), first);
  EXPECT_TRUE(flight.on_time(first - milliseconds(1)).empty());
  EXPECT_EQ(flight.on_time(first), Numbers{1});
  EXPECT_FALSE(flight.due());
  send(1, first);
  EXPECT_EQ(*flight.due(), 3 * first);
  EXPECT_EQ(flight.on_time(3 * first), Numbers{2});
  EXPECT_EQ(flight.timeouts(), 2);
  for (int i = 0; i < 20; ++i) {
    send(1, seconds(1000 * i));
    EXPECT_LE(*flight.due() - seconds(1000 * i), RoundTrip::kMaxTimeout);
    EXPECT_FALSE(flight.on_time(seconds(1000 * i + 31)).empty());
  }
}

TEST_F(FlightTest, AnAcknowledgementRestoresPatience) {
  send(1);
  (void)flight.on_time(seconds(3));
  EXPECT_EQ(flight.patience(), 2 * RoundTrip::kFirstTimeout);
  send(1, seconds(3));
  (void)flight.on_ack({2, 0}, seconds(3) + milliseconds(100));
  EXPECT_LT(flight.patience(), seconds(1));
}

TEST_F(FlightTest, OnALinkThatAnsweredOneLossIsNoSilence) {
  send(1);
  (void)flight.on_ack({1, 0}, milliseconds(600));
  const Duration patience = flight.patience();
  send(1, seconds(1));
  EXPECT_FALSE(flight.on_time(seconds(1) + patience).empty());
  EXPECT_EQ(flight.patience(), patience);
  send(1, seconds(5));
  EXPECT_FALSE(flight.on_time(seconds(5) + patience).empty());
  EXPECT_EQ(flight.patience(), 2 * patience);
}

TEST_F(FlightTest, WhatThePeerWaitedIsNoneOfTheLinks) {
  send(1);
  EXPECT_EQ(flight.on_ack({1, 0, 100}, milliseconds(600)).round_trip, milliseconds(500));
  EXPECT_EQ(flight.round_trip().smoothed(), milliseconds(600)) << "what a timeout must wait for";
  send(1, seconds(1));
  const auto news = flight.on_ack({2, 0, Ack::kDelayUnknown}, seconds(4));
  EXPECT_EQ(news.acked, Numbers{2});
  EXPECT_FALSE(news.round_trip) << "the acknowledgement before it was lost";
}

TEST_F(FlightTest, EverLessIsSaidIntoSilence) {
  MonotonicTime now{};
  send(1, now);
  for (const int window : {8, 4, 2, 1, 1, 1}) {
    now += RoundTrip::kMaxTimeout + seconds(1);
    ASSERT_FALSE(flight.on_time(now).empty());
    send(window - 1, now);
    EXPECT_TRUE(flight.evidence_may_go());
    send(1, now);
    EXPECT_FALSE(flight.evidence_may_go());
  }
}

TEST_F(FlightTest, AnUrgentFrameIsGivenUpEarlyAFewTimesAndDoesNotCountAsSilence) {
  send(1);
  (void)flight.on_ack({1, 0}, milliseconds(600));
  MonotonicTime now = seconds(1);
  for (int i = 0; i < Flight::kUrgentTries; ++i) {
    const std::uint32_t number = flight.next_number(out_of_reach);
    flight.sent(number, Flight::Load::urgent, {100, 100}, now);
    EXPECT_EQ(*flight.due(), now + milliseconds(360));
    now += milliseconds(360);
    EXPECT_EQ(flight.on_time(now), Numbers{number});
    EXPECT_EQ(flight.timeouts(), 0);
  }
  const std::uint32_t number = flight.next_number(out_of_reach);
  flight.sent(number, Flight::Load::urgent, {100, 100}, now);
  EXPECT_EQ(*flight.due(), now + flight.patience());
  const auto news = flight.on_ack({number - 1, 0}, now);
  EXPECT_EQ(news.found_again, 5U) << "they had only been slow";
}

TEST_F(FlightTest, TellsTheRoundTripOfTheNewestFrameAndItsLength) {
  flight.sent(flight.next_number(out_of_reach), Flight::Load::evidence, {900, 900}, seconds(1));
  flight.sent(flight.next_number(out_of_reach), Flight::Load::other, {70, 970}, seconds(2));
  EXPECT_EQ(flight.bytes_under_way(), 970U);
  const auto news = flight.on_ack({2, 0}, seconds(3));
  EXPECT_EQ(news.round_trip, seconds(1));
  EXPECT_EQ(news.newest.bytes, 70U);
  EXPECT_EQ(news.newest.total, 970U);
  EXPECT_EQ(flight.bytes_under_way(), 0U);
}

TEST_F(FlightTest, EvidenceWaitsBeforeItsOldestFrameComesOutOfReach) {
  send(1);
  while (flight.evidence_may_go()) {
    const std::uint32_t number = flight.next_number(out_of_reach);
    ASSERT_LE(number, Flight::kReach);
  }
  EXPECT_TRUE(out_of_reach.empty());
}

TEST_F(FlightTest, AFrameOutOfReachIsGivenUpAndItsAcknowledgementNotBelieved) {
  send(1);
  for (std::uint32_t i = 0; i < Flight::kReach; ++i) (void)flight.next_number(out_of_reach);
  EXPECT_EQ(out_of_reach, Numbers{1});
  EXPECT_TRUE(flight.on_ack({Flight::kReach, 0}, milliseconds(10)).acked.empty());
}

TEST_F(FlightTest, AcknowledgementsOfNumbersNeverSentAreIgnored) {
  send(2);
  EXPECT_TRUE(flight.on_ack({3, 0}, milliseconds(10)).acked.empty());
}

TEST_F(FlightTest, ANewSessionBeginsAfresh) {
  send(8);
  flight.reset();
  EXPECT_TRUE(flight.evidence_may_go());
  EXPECT_EQ(flight.next_number(out_of_reach), 1U);
}

}  // namespace
}  // namespace cairn::proto
