#include "proto/sync/budget.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>

namespace cairn::proto {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A sender of long frames over a link of some rate, delay and loss, in virtual time.
class PacedLink {
 public:
  struct Link {
    double rate_bit_s = 9'600.0;
    Duration round_trip = milliseconds(600);
    Duration jitter{};
    double loss = 0.0;
    std::size_t frame_bytes = 1'250;
  };

  PacedLink(unsigned seed, const Link& link, const BudgetConfig& config = {})
      : budget(config), link_(link), random_(seed) {}

  void run(Duration length) {
    for (const MonotonicTime end = now + length; now < end; now += milliseconds(5)) step();
  }
  void set(const Link& link) { link_ = link; }

  Budget budget;
  MonotonicTime now = seconds(10);
  std::uint64_t sent_bytes = 0;
  Duration longest_queue{};
  double queue_seconds = 0.0;  ///< Summed over time: queue [s] times seconds.
  Duration queue() const { return std::max(free_at_ - now, Duration{}); }

 private:
  struct Answer {
    MonotonicTime at;
    MonotonicTime sent_at;
    Budget::Mark mark;
  };

  void step() {
    while (!answers_.empty() && answers_.front().at <= now) {
      const Answer answer = answers_.front();
      answers_.pop_front();
      budget.on_fate(1, 0);
      budget.on_round_trip(now - answer.sent_at, answer.mark, now);
    }
    while (budget.may_send(Traffic::map, now)) send();
    longest_queue = std::max(longest_queue, queue());
    queue_seconds += to_seconds(queue()) * 5e-3;
  }
  void send() {
    const std::size_t bytes = link_.frame_bytes;
    budget.sent(Traffic::map, bytes, now);
    sent_bytes += bytes;
    free_at_ =
        std::max(free_at_, now) + from_seconds(static_cast<double>(bytes) * 8.0 / link_.rate_bit_s);
    if (std::bernoulli_distribution(link_.loss)(random_)) {
      budget.on_fate(0, 1);
      return;
    }
    auto jitter = std::uniform_int_distribution<Duration::rep>(0, link_.jitter.count());
    MonotonicTime at = free_at_ + link_.round_trip + Duration(jitter(random_));
    if (!answers_.empty()) at = std::max(at, answers_.back().at);
    answers_.push_back({at, now, {bytes, budget.total()}});
  }

  Link link_;
  std::mt19937 random_;
  MonotonicTime free_at_{};
  std::deque<Answer> answers_;
};

double used(PacedLink& world, Duration length, double rate_bit_s) {
  const std::uint64_t before = world.sent_bytes;
  world.run(length);
  return static_cast<double>(world.sent_bytes - before) * 8.0 / to_seconds(length) / rate_bit_s;
}

TEST(Budget, UsesMostOfAnyLinkAndMakesNoLastingQueue) {
  for (const double rate : {4'800.0, 9'600.0, 32'000.0, 64'000.0, 1e6}) {
    for (const double loss : {0.0, 0.1, 0.3}) {
      PacedLink world(17, {.rate_bit_s = rate, .loss = loss});
      world.run(seconds(60));
      world.longest_queue = {};
      world.queue_seconds = 0.0;
      const double share = used(world, seconds(120), rate);
      EXPECT_GT(share, 0.8) << rate << " bit/s, loss " << loss;
      EXPECT_LE(share, 1.05) << rate << " bit/s, loss " << loss;
      const double packet_s = Budget::kLongestPacket * 8.0 / rate;
      const double target_s = to_seconds(Budget::kQueueTarget);
      EXPECT_LT(world.queue_seconds / 120.0, 2 * target_s + 2 * packet_s)
          << rate << " bit/s, loss " << loss;
      EXPECT_LT(to_seconds(world.longest_queue), 4 * target_s + 10 * packet_s)
          << rate << " bit/s, loss " << loss;
    }
  }
}

TEST(Budget, IsNotFooledByJitter) {
  PacedLink world(3, {.rate_bit_s = 64'000, .jitter = milliseconds(150), .loss = 0.2});
  world.run(seconds(60));
  EXPECT_GT(used(world, seconds(120), 64'000), 0.6);
}

TEST(Budget, TheFirstQueueOnAThinLinkIsAFewPackets) {
  PacedLink world(15, {.rate_bit_s = 9'600});
  world.run(seconds(60));
  EXPECT_LT(world.longest_queue, seconds(6));
}

TEST(Budget, AKnownRateAsCeilingMakesNoQueueAtAll) {
  PacedLink world(16, {.rate_bit_s = 9'600, .loss = 0.3},
                  {.first_bit_s = 9'000.0, .ceiling_bit_s = 9'000.0});
  world.run(seconds(60));
  EXPECT_LT(world.longest_queue, milliseconds(2'200)) << "a packet behind the one that is leaving";
}

TEST(Budget, FollowsALinkThatBecomesThinnerAndWiderAgain) {
  PacedLink world(9, {.rate_bit_s = 64'000});
  world.run(seconds(60));
  world.set({.rate_bit_s = 16'000});
  world.run(seconds(60));
  EXPECT_LT(world.budget.rate_bit_s(), 20'000);
  EXPECT_LT(world.queue(), seconds(2));
  world.set({.rate_bit_s = 64'000});
  world.run(seconds(60));
  EXPECT_GT(world.budget.rate_bit_s(), 45'000);
}

TEST(Budget, StaysBetweenFloorAndCeiling) {
  const BudgetConfig config{.floor_bit_s = 5'000, .first_bit_s = 8'000, .ceiling_bit_s = 20'000};
  PacedLink wide(1, {.rate_bit_s = 1e6}, config);
  wide.run(seconds(30));
  EXPECT_EQ(wide.budget.rate_bit_s(), 20'000);
  PacedLink thin(1, {.rate_bit_s = 2'000}, config);
  thin.run(seconds(120));
  EXPECT_GE(thin.budget.rate_bit_s(), 5'000);
  Budget silent(config);
  for (int i = 0; i < 10; ++i) silent.on_silence();
  EXPECT_EQ(silent.rate_bit_s(), 8'000) << "whoever says nothing has not said that it is thin";
}

TEST(Budget, AfterASilenceTheLinkIsWhatItWas) {
  PacedLink world(5, {.rate_bit_s = 64'000});
  world.run(seconds(60));
  const double before = world.budget.rate_bit_s();
  ASSERT_GT(before, 30'000);
  for (int i = 0; i < 5; ++i) world.budget.on_silence();
  EXPECT_LT(world.budget.rate_bit_s(), 10'000);
  world.budget.on_return();
  EXPECT_EQ(world.budget.rate_bit_s(), before);
}

TEST(Budget, DoesNotGrowOnARateThatIsNotUsed) {
  Budget budget;
  const double before = budget.rate_bit_s();
  MonotonicTime now = seconds(1);
  for (int i = 0; i < 100; ++i, now += seconds(1)) {
    ASSERT_TRUE(budget.may_send(Traffic::map, now));
    budget.sent(Traffic::map, 200, now);
    budget.on_round_trip(milliseconds(300), {200, budget.total()}, now);
  }
  EXPECT_EQ(budget.rate_bit_s(), before);
}

TEST(Budget, ControlNeverWaitsAndIsPaidForAfterwards) {
  Budget budget;
  const MonotonicTime now = seconds(1);
  while (budget.may_send(Traffic::map, now)) budget.sent(Traffic::map, 1'250, now);
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(budget.may_send(Traffic::control, now));
    budget.sent(Traffic::control, 1'250, now);
  }
  EXPECT_FALSE(budget.may_send(Traffic::pose, now));
  EXPECT_LE(budget.due(Traffic::map, now) - now, Budget::kMapPatience);
}

TEST(Budget, APoseLeavesBeforeTheMapButNotWithoutEnd) {
  Budget budget;
  const MonotonicTime now = seconds(1);
  while (budget.may_send(Traffic::map, now)) budget.sent(Traffic::map, 1'250, now);
  int poses = 0;
  while (budget.may_send(Traffic::pose, now) && poses < 1'000) {
    budget.sent(Traffic::pose, 120, now);
    ++poses;
  }
  EXPECT_GE(poses, 1);
  EXPECT_LT(poses, 50);
}

TEST(Budget, TheMapIsNeverStarvedByMoreUrgentTraffic) {
  Budget budget;
  MonotonicTime now = seconds(1);
  int maps = 0;
  for (; now < seconds(101); now += milliseconds(20)) {
    budget.sent(Traffic::control, 1'250, now);
    if (budget.may_send(Traffic::map, now)) {
      budget.sent(Traffic::map, 1'250, now);
      ++maps;
    }
  }
  EXPECT_GE(maps, 9);
}

TEST(Budget, SaysExactlyWhenAWaitIsOver) {
  Budget budget;
  MonotonicTime now = seconds(1);
  for (int i = 0; i < 1'000; ++i) {
    while (budget.may_send(Traffic::map, now)) {
      budget.sent(Traffic::map, static_cast<std::size_t>(40 + i), now);
    }
    const MonotonicTime due = budget.due(Traffic::map, now);
    ASSERT_GT(due, now);
    ASSERT_FALSE(budget.may_send(Traffic::map, due - Duration(2)));
    ASSERT_TRUE(budget.may_send(Traffic::map, due));
    now = due;
  }
}

TEST(Budget, CountsBytesByWhatTheyWereFor) {
  Budget budget;
  budget.sent(Traffic::control, 1, seconds(1));
  budget.sent(Traffic::pose, 20, seconds(1));
  budget.sent(Traffic::map, 300, seconds(1));
  EXPECT_EQ(budget.sent_bytes(), (TrafficBytes{1, 20, 300}));
}

TEST(Budget, RefusesANonsensicalConfiguration) {
  EXPECT_TRUE(validate(BudgetConfig{}));
  EXPECT_FALSE(validate({.floor_bit_s = 0.0}));
  EXPECT_FALSE(validate({.floor_bit_s = 9'000.0, .ceiling_bit_s = 8'000.0}));
}

TEST(Budget, WhatWasRepeatedEarlyAndThenFoundIsNoLoss) {
  Budget budget{BudgetConfig{}};
  for (int i = 0; i < 20; ++i) {
    budget.on_fate(0, 1);
    EXPECT_GT(budget.loss(), 0.0);
    budget.on_fate(1, 0, 1);
  }
  EXPECT_LT(budget.loss(), 0.01);
  for (int i = 0; i < 20; ++i) budget.on_fate(1, 1);
  EXPECT_GT(budget.loss(), 0.1);
}

}  // namespace
}  // namespace cairn::proto
