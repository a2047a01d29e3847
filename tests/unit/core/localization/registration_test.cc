#include "core/localization/registration.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "core/common/angle.h"
#include "tests/unit/core/localization/test_ground.h"

namespace cairn {
namespace {

const Pose kRobot{1.0, -0.7, 0.2, 0.0, 0.0, radians(25.0)};

template <class Ground>
Registration registered(const Ground& ground, const Pose& off, RegistrationConfig config = {},
                        unsigned seed = 1, double known_share = 0.8) {
  std::mt19937_64 random(seed);
  const HeightMap long_term = test::long_term_of(ground, random, known_share);
  const HeightMap short_term = test::short_term_of(ground, kRobot, random);
  RegistrationPrior prior;
  prior.T_site_submap = {
      kRobot.x_m + off.x_m,        kRobot.y_m + off.y_m, kRobot.z_m + off.z_m, 0.0, 0.0,
      kRobot.yaw_rad + off.yaw_rad};
  prior.covariance = test::sigmas(0.4, radians(5.0));
  return register_map(short_term, prior, long_term, config);
}

const Pose kOff{0.5, -0.6, 0.15, 0.0, 0.0, radians(6.0)};

TEST(Registration, FindsTheWayBackToACentimetre) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Registration r = registered(test::RichGround{}, kOff, {}, seed);
    ASSERT_TRUE(r.accepted) << r.why << ", seed " << seed;
    EXPECT_NEAR(r.T_site_submap.x_m, kRobot.x_m, 0.02) << "seed " << seed;
    EXPECT_NEAR(r.T_site_submap.y_m, kRobot.y_m, 0.02) << "seed " << seed;
    EXPECT_NEAR(r.T_site_submap.z_m, kRobot.z_m, 0.02) << "seed " << seed;
    EXPECT_NEAR(r.T_site_submap.yaw_rad, kRobot.yaw_rad, radians(0.3)) << "seed " << seed;
    EXPECT_TRUE(r.position_observable);
  }
}

TEST(Registration, TheThesisFindsItWithinTwoCells) {
  RegistrationConfig config;
  config.mode = RegistrationMode::thesis;
  const Registration r = registered(test::RichGround{}, kOff, config);
  ASSERT_TRUE(r.accepted);
  EXPECT_NEAR(r.T_site_submap.x_m, kRobot.x_m, 0.25);
  EXPECT_NEAR(r.T_site_submap.y_m, kRobot.y_m, 0.25);
  EXPECT_NEAR(r.T_site_submap.yaw_rad, kRobot.yaw_rad, radians(2.0));
}

TEST(Registration, OnFlatGroundCorrectsTheHeightAndInventsNothing) {
  const Registration r = registered(test::FlatGround{}, kOff);
  ASSERT_TRUE(r.accepted) << r.why << '\n' << r.information;
  EXPECT_FALSE(r.position_observable);
  EXPECT_NEAR(r.T_site_submap.x_m, kRobot.x_m + kOff.x_m, 0.05);
  EXPECT_NEAR(r.T_site_submap.y_m, kRobot.y_m + kOff.y_m, 0.05);
  EXPECT_NEAR(r.T_site_submap.z_m, kRobot.z_m, 0.02);
  EXPECT_GT(r.covariance(0, 0), 0.3 * 0.3);
  EXPECT_GT(r.covariance(1, 1), 0.3 * 0.3);
}

TEST(Registration, InACorridorCorrectsAcrossAndNotAlong) {
  const Registration r =
      registered(test::Corridor{}, {0.5, 0.3, 0.0, 0.0, 0.0, radians(2.0)}, {}, 1, 1.0);
  ASSERT_TRUE(r.accepted) << r.why << '\n' << r.information;
  EXPECT_FALSE(r.position_observable);
  EXPECT_NEAR(r.T_site_submap.y_m, kRobot.y_m, 0.04);
  EXPECT_NEAR(r.T_site_submap.x_m, kRobot.x_m + 0.5, 0.15);
  EXPECT_GT(r.covariance(0, 0), 4.0 * r.covariance(1, 1));
}

TEST(Registration, WithALongTermMapOfAnotherPlaceIsRefused) {
  std::mt19937_64 random(1);
  const auto elsewhere = [](double x, double y) { return test::RichGround{}(x + 40.0, y - 70.0); };
  RegistrationPrior prior;
  prior.T_site_submap = kRobot;
  prior.covariance = test::sigmas(0.1, radians(1.0));
  const Registration r = register_map(test::short_term_of(test::RichGround{}, kRobot, random),
                                      prior, test::long_term_of(elsewhere, random), {});
  EXPECT_FALSE(r.accepted);
  EXPECT_FALSE(r.why.empty());
  EXPECT_DOUBLE_EQ(r.T_site_submap.x_m, kRobot.x_m);
  EXPECT_EQ(r.covariance, prior.covariance);
}

TEST(Registration, BeyondTheNarrowWindowTheWideSearchFindsIt) {
  std::mt19937_64 random(4);
  const test::RichGround ground;
  RegistrationPrior prior;
  prior.T_site_submap = {kRobot.x_m + 2.0, kRobot.y_m - 1.5, kRobot.z_m, 0.0, 0.0, kRobot.yaw_rad};
  prior.covariance = test::sigmas(1.0, radians(5.0));
  RegistrationConfig config;
  config.min_wide_distinctness = 0.1;
  const HeightMap long_term = test::long_term_of(ground, random);
  const Registration r =
      register_map(test::short_term_of(ground, kRobot, random), prior, long_term, config);
  ASSERT_TRUE(r.accepted) << r.why << "; distinctness " << r.distinctness;
  EXPECT_TRUE(r.wide);
  EXPECT_NEAR(r.T_site_submap.x_m, kRobot.x_m, 0.03);
  EXPECT_NEAR(r.T_site_submap.y_m, kRobot.y_m, 0.03);
}

TEST(Registration, RefusesWhatItCannotUse) {
  const HeightMap empty(test::kCellMm);
  std::mt19937_64 random(1);
  const HeightMap map = test::short_term_of(test::RichGround{}, kRobot, random);
  RegistrationPrior prior;
  EXPECT_EQ(register_map(empty, prior, map, {}).why, "the short-term map is empty");
  EXPECT_FALSE(register_map(map, prior, empty, {}).accepted);
  prior.T_site_submap.y_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(register_map(map, prior, map, {}).why, "the prior is not finite");
}

TEST(Registration, OfOneCellIsRefused) {
  HeightMap speck(test::kCellMm);
  speck.set({0, 0}, {100, 200});
  EXPECT_FALSE(register_map(speck, {}, speck, {}).accepted);
}

}  // namespace
}  // namespace cairn
