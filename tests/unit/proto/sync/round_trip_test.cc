#include "proto/sync/round_trip.h"

#include <gtest/gtest.h>

namespace cairn::proto {
namespace {

using std::chrono::milliseconds;

TEST(RoundTrip, BeforeAnyMeasurementItWaitsForALongFrameOnAThinLink) {
  EXPECT_EQ(RoundTrip().timeout(), RoundTrip::kFirstTimeout);
  EXPECT_FALSE(RoundTrip().smoothed());
}

TEST(RoundTrip, ASteadyLinkIsKnownClosely) {
  RoundTrip rtt;
  for (int i = 0; i < 50; ++i) rtt.measured(milliseconds(600));
  EXPECT_EQ(*rtt.smoothed(), milliseconds(600));
  EXPECT_LT(rtt.timeout(), milliseconds(610));
}

TEST(RoundTrip, AnUnsteadyLinkIsGivenMoreTime) {
  RoundTrip rtt;
  for (int i = 0; i < 50; ++i) rtt.measured(milliseconds(i % 2 == 0 ? 200 : 1000));
  EXPECT_GT(rtt.timeout(), milliseconds(1200));
}

TEST(RoundTrip, TheTimeoutStaysWithinItsBounds) {
  RoundTrip quick;
  for (int i = 0; i < 50; ++i) quick.measured(Duration(100));
  EXPECT_EQ(quick.timeout(), RoundTrip::kMinTimeout);
  RoundTrip slow;
  slow.measured(std::chrono::hours(1));
  EXPECT_EQ(slow.timeout(), RoundTrip::kMaxTimeout);
}

}  // namespace
}  // namespace cairn::proto
