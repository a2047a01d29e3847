#include "tests/support/link_emulator/channel.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace cairn::test {
namespace {

using namespace std::chrono_literals;

Channel::Packet packet(std::size_t size, std::uint8_t content = 0x55) {
  return Channel::Packet(size, content);
}

/// Sends `count` packets of 100 bytes, 100 ms apart, and counts what arrives.
std::size_t arrivals(ChannelConfig config, std::uint64_t seed, std::size_t count = 10'000) {
  Channel channel(seed, std::move(config));
  std::size_t arrived = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const LinkTime now = 100ms * i;
    channel.offer(packet(100), now);
    while (channel.receive(now)) ++arrived;
  }
  while (channel.receive(LinkTime::max())) ++arrived;
  return arrived;
}

TEST(Channel, APacketTakesItsTimeAtTheRateAndThenTheDelay) {
  Channel channel(1, {.rate_bit_s = 9'600, .delay = 300ms});
  channel.offer(packet(120), 5s);
  EXPECT_EQ(channel.next_arrival(), 5s + 100ms + 300ms);
  EXPECT_FALSE(channel.receive(5s + 399ms));
  EXPECT_EQ(channel.receive(5s + 400ms), packet(120));
}

TEST(Channel, PacketsQueueBehindEachOtherAndTheTailIsDropped) {
  Channel channel(1, {.rate_bit_s = 8'000, .queue = 1s});
  for (int i = 0; i < 20; ++i) channel.offer(packet(100), 0s);  // 100 ms each.
  EXPECT_EQ(channel.counters().queue_dropped.packets, 20U - 11U);
  std::size_t arrived = 0;
  while (channel.receive(550ms)) ++arrived;
  EXPECT_EQ(arrived, 5U);
  EXPECT_EQ(channel.counters().longest_queue, 1s);
}

TEST(Channel, LosesAsManyAsItsSeedSaysAndTheSameEachTime) {
  const std::size_t arrived = arrivals({.loss = 0.2}, 7);
  EXPECT_NEAR(static_cast<double>(arrived), 8'000, 150);
  EXPECT_EQ(arrivals({.loss = 0.2}, 7), arrived);
  EXPECT_NE(arrivals({.loss = 0.2}, 8), arrived);
}

TEST(Channel, LosesInBurstsOfTheLengthAskedFor) {
  Channel channel(3, {.burst_begin = 0.05, .burst_end = 0.2});
  std::size_t bursts = 0;
  bool losing = false;
  for (int i = 0; i < 20'000; ++i) {
    const std::uint64_t before = channel.counters().lost.packets;
    channel.offer(packet(10), 1ms * i);
    const bool lost = channel.counters().lost.packets > before;
    if (lost && !losing) ++bursts;
    losing = lost;
  }
  const double length =
      static_cast<double>(channel.counters().lost.packets) / static_cast<double>(bursts);
  EXPECT_NEAR(length, 5.0, 0.7);
}

TEST(Channel, DoublesPackets) {
  EXPECT_NEAR(static_cast<double>(arrivals({.duplicate = 0.1}, 5)), 11'000, 150);
}

TEST(Channel, KeepsTheOrderUnlessToldToTurnIt) {
  for (const bool reorder : {false, true}) {
    Channel channel(4, {.delay = 10ms, .jitter = 50ms, .reorder = reorder});
    for (std::uint8_t i = 0; i < 100; ++i) channel.offer(packet(1, i), 1ms * i);
    bool ordered = true;
    std::uint8_t last = 0;
    while (const auto got = channel.receive(10s)) {
      ordered = ordered && (*got)[0] >= last;
      last = (*got)[0];
    }
    EXPECT_EQ(ordered, !reorder);
  }
}

TEST(Channel, TurnsBitsAtTheirRate) {
  Channel channel(6, {.bit_error = 1e-3});
  std::size_t wrong = 0;
  for (int i = 0; i < 1'000; ++i) {
    channel.offer(packet(125, 0), 1s * i);
    const auto arrived = channel.receive(1s * i);
    ASSERT_TRUE(arrived);
    for (const std::uint8_t byte : *arrived) {
      wrong += static_cast<std::size_t>(__builtin_popcount(byte));
    }
  }
  EXPECT_NEAR(static_cast<double>(wrong), 1'000, 100);
  EXPECT_NEAR(static_cast<double>(channel.counters().damaged.packets), 632, 50);
}

TEST(Channel, LosesAllDuringAnOutage) {
  Channel channel(1, {.outages = {{10s, 20s}}});
  for (int s = 0; s < 30; ++s) channel.offer(packet(10), 1s * s);
  EXPECT_EQ(channel.counters().outage_dropped.packets, 10U);
}

TEST(Channel, AccountsForEveryPacket) {
  Channel channel(9, {.rate_bit_s = 64'000, .queue = 100ms, .loss = 0.1, .duplicate = 0.1});
  for (int i = 0; i < 1'000; ++i) channel.offer(packet(200), 20ms * i);
  while (channel.receive(LinkTime::max())) {
  }
  const ChannelCounters& c = channel.counters();
  EXPECT_EQ(c.offered.packets + c.duplicated.packets,
            c.delivered.packets + c.lost.packets + c.queue_dropped.packets);
  EXPECT_EQ(to_json(c)["offered"]["bytes"], 200'000);
}

}  // namespace
}  // namespace cairn::test
