#include "proto/sync/ack_log.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace cairn::proto {
namespace {

Ack without_delay(std::uint32_t cumulative, std::uint64_t bitmap) {
  return {cumulative, bitmap, Ack::kDelayUnknown};
}

TEST(AckLog, BeginsWithNothing) {
  EXPECT_EQ(AckLog().ack(), without_delay(0, 0));
  EXPECT_FALSE(AckLog().is_done(1));
}

TEST(AckLog, FramesInOrderMoveTheCumulativeNumber) {
  AckLog log;
  for (std::uint32_t n = 1; n <= 200; ++n) log.done(n);
  EXPECT_EQ(log.ack(), without_delay(200, 0));
}

TEST(AckLog, AGapIsToldByTheBitmapUntilItCloses) {
  AckLog log;
  for (const std::uint32_t n : {1U, 3U, 4U, 6U}) log.done(n);
  EXPECT_EQ(log.ack(), without_delay(1, 0b1011U));
  EXPECT_FALSE(log.is_done(2));
  EXPECT_TRUE(log.is_done(4));
  EXPECT_FALSE(log.is_done(5));
  log.done(2);
  EXPECT_EQ(log.ack(), without_delay(4, 0b1U));
  log.done(5);
  EXPECT_EQ(log.ack(), without_delay(6, 0));
}

TEST(AckLog, TellsOnceHowLongTheNewestThatAskedWaited) {
  using std::chrono::milliseconds;
  AckLog log;
  log.done(1, milliseconds(100));
  log.done(3, milliseconds(300));
  log.done(2, milliseconds(350));  // It was overtaken.
  log.done(4);                     // It asked for nothing.
  EXPECT_EQ(log.tell(milliseconds(380)), (Ack{4, 0, 80}));
  EXPECT_EQ(log.tell(milliseconds(900)), without_delay(4, 0));
  log.done(5, milliseconds(1'000));
  EXPECT_EQ(log.tell(milliseconds(100'000)).delay_ms, Ack::kDelayUnknown - 1);
}

TEST(AckLog, ANumberFarAheadSlidesTheWindow) {
  AckLog log;
  log.done(2);
  log.done(70);
  EXPECT_EQ(log.ack().cumulative, 5U);
  EXPECT_TRUE(log.is_done(1)) << "too old to be told apart counts as done";
  EXPECT_TRUE(log.is_done(70));
  EXPECT_FALSE(log.is_done(69));
  log.done(4'000'000'000U);
  EXPECT_TRUE(log.is_done(4'000'000'000U));
  EXPECT_FALSE(log.is_done(3'999'999'999U));
}

TEST(AckLog, AgreesWithASetForAnyOrderWithinTheWindow) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed);
    AckLog log;
    std::set<std::uint32_t> done;
    for (std::uint32_t base = 0; base < 300; ++base) {
      const auto n = static_cast<std::uint32_t>(base + 1 + random() % 30);
      log.done(n);
      done.insert(n);
      for (std::uint32_t i = log.ack().cumulative + 1; i < base + 60; ++i) {
        ASSERT_EQ(log.is_done(i), done.contains(i)) << "seed " << seed << " number " << i;
      }
    }
  }
}

}  // namespace
}  // namespace cairn::proto
