#include "core/pose/incline_trust.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

using std::chrono::milliseconds;

constexpr double kStepRad = 0.01;

/// A robot whose nose goes down by `pitch_rad` at each of so many readings, 10 a second.
void pitch(InclineTrust& trust, double pitch_rad, int readings, int from = 0) {
  Pose pose;
  for (int i = 1; i <= readings; ++i) {
    Pose next = pose;
    next.pitch_rad += pitch_rad;
    trust.note(pose, next, milliseconds(100 * (from + i)));
    pose = next;
  }
}

TEST(InclineTrust, OfARobotThatDoesNotTiltIsThatOfItsInclinometer) {
  const InclineTrustConfig config;
  InclineTrust trust(config);
  pitch(trust, 0.0, 10);
  EXPECT_DOUBLE_EQ(trust.sigma_rad(), config.incline_sigma_rad);
  EXPECT_DOUBLE_EQ(trust.range_m(trust.sigma_rad()),
                   config.height_sigma_m / config.incline_sigma_rad);
}

TEST(InclineTrust, FallsWhileTheInclineChangesAndComesBack) {
  const InclineTrustConfig config;
  InclineTrust trust(config);
  pitch(trust, kStepRad, 30);
  // For long enough at 0.1 rad/s, the lag is the rate times its time.
  EXPECT_NEAR(trust.sigma_rad(), config.incline_sigma_rad + 0.1 * config.incline_lag_s, 1e-3);
  EXPECT_LT(trust.range_m(trust.sigma_rad()), 2.0);
  pitch(trust, 0.0, 30, 30);
  EXPECT_NEAR(trust.sigma_rad(), config.incline_sigma_rad, 1e-3);
}

TEST(InclineTrust, NoiseOfTheReadingsIsNoMotion) {
  InclineTrust trust{InclineTrustConfig{}};
  for (int i = 0; i < 40; ++i) pitch(trust, i % 2 == 0 ? kStepRad : -kStepRad, 1, i);
  EXPECT_LT(trust.sigma_rad(), 0.02);
}

TEST(InclineTrust, AReadingThatIsNotNewerChangesNothing) {
  InclineTrust trust{InclineTrustConfig{}};
  pitch(trust, kStepRad, 5);
  const double before = trust.sigma_rad();
  trust.note({}, {.pitch_rad = 1.0}, milliseconds(500));
  EXPECT_DOUBLE_EQ(trust.sigma_rad(), before);
}

}  // namespace
}  // namespace cairn
