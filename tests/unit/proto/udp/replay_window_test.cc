#include "proto/udp/replay_window.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace cairn::proto {
namespace {

constexpr std::uint64_t kOldest = ReplayWindow::kBits - 64;  // Age that is surely still told apart.

TEST(ReplayWindow, TakesEachCounterOnce) {
  ReplayWindow window;
  for (const std::uint64_t counter : {0U, 5U, 3U, 4U, 100U, 99U}) {
    ASSERT_TRUE(window.is_new(counter));
    window.accept(counter);
    EXPECT_FALSE(window.is_new(counter));
  }
  EXPECT_TRUE(window.is_new(1));
}

TEST(ReplayWindow, SaysWhichIsTheHighestSoFar) {
  ReplayWindow window;
  EXPECT_TRUE(window.accept(7));
  EXPECT_FALSE(window.accept(6));
  EXPECT_TRUE(window.accept(8));
}

TEST(ReplayWindow, RefusesWhatIsTooOldToKnow) {
  ReplayWindow window;
  window.accept(10'000);
  EXPECT_TRUE(window.is_new(10'001 - kOldest));
  EXPECT_FALSE(window.is_new(10'000 - ReplayWindow::kBits));
  EXPECT_FALSE(window.is_new(0));
}

TEST(ReplayWindow, AgreesWithASetOnRandomCounters) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    ReplayWindow window;
    std::set<std::uint64_t> seen;
    std::uint64_t at = 0;
    for (int i = 0; i < 20'000; ++i) {
      at += std::uniform_int_distribution<std::uint64_t>(0, i % 500 == 0 ? 5'000 : 3)(random);
      const std::uint64_t back = std::uniform_int_distribution<std::uint64_t>(0, 1'900)(random);
      const std::uint64_t counter = at > back ? at - back : 0;
      if (!seen.empty() && *seen.rbegin() >= counter + kOldest) continue;
      ASSERT_EQ(window.is_new(counter), !seen.contains(counter)) << "seed " << seed;
      if (seen.insert(counter).second) window.accept(counter);
    }
  }
}

TEST(ReplayWindow, FindsTheWholeCounterFromItsLowBitsAcrossTurns) {
  ReplayWindow window;
  constexpr std::uint64_t kTurn = 1U << 24U;
  for (std::uint64_t at = 0; at < 3 * kTurn; at += 99'991) {
    EXPECT_EQ(window.expand(static_cast<std::uint32_t>(at % kTurn)), at);
    window.accept(at);
    if (at < 50) continue;
    EXPECT_EQ(window.expand(static_cast<std::uint32_t>((at - 50) % kTurn)), at - 50);
    EXPECT_EQ(window.expand(static_cast<std::uint32_t>((at + kTurn / 2 - 10) % kTurn)),
              at + kTurn / 2 - 10);
  }
}

}  // namespace
}  // namespace cairn::proto
