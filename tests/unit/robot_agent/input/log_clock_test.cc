#include "robot_agent/input/log_clock.h"

#include <gtest/gtest.h>

namespace cairn::agent {
namespace {

TEST(LogClock, StartsAtZeroAndFollowsTheStamps) {
  LogClock clock({976052857.3, 976052857.4});
  EXPECT_EQ(clock.time_of(976052857.3), MonotonicTime{0});
  EXPECT_NEAR(to_seconds(clock.time_of(976052859.3)), 2.0, 1e-5);
  EXPECT_NEAR(to_seconds(clock.time_of(976052858.9)), 1.6, 1e-5) << "out of order by a little";
  EXPECT_NEAR(to_seconds(clock.settled()), 0.0, 1e-5);
}

TEST(LogClock, TakesAJumpAsATenthOfASecond) {
  LogClock clock({0.0, 1.0, 2.0});
  (void)clock.time_of(0.0);
  EXPECT_NEAR(to_seconds(clock.time_of(1e9)), 0.1, 1e-6);
  EXPECT_NEAR(to_seconds(clock.time_of(1e9 + 1)), 1.1, 1e-6);
  EXPECT_NEAR(to_seconds(clock.time_of(5.0)), 1.2, 1e-6);
  EXPECT_NEAR(to_seconds(clock.time_of(6.0)), 2.2, 1e-6);
}

TEST(LogClock, CountsReadingsWhenTheStampsAreOfNoUse) {
  LogClock clock({0.0, 6.979, 1.961, 3.4e-86, 0.0, 0.0, 0.0});
  EXPECT_EQ(clock.time_of(0.0), MonotonicTime{0});
  EXPECT_NEAR(to_seconds(clock.time_of(6.979)), 0.1, 1e-6);
  EXPECT_NEAR(to_seconds(clock.time_of(1.961)), 0.2, 1e-6);
  EXPECT_NEAR(to_seconds(clock.settled()), 0.2, 1e-6) << "none is waited for";
}

}  // namespace
}  // namespace cairn::agent
