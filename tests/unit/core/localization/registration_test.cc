#include "core/localization/registration.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

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
  EXPECT_NEAR(r.T_site_submap.x_m, kRobot.x_m + 0.5, 0.1);
  EXPECT_GT(r.covariance(0, 0), 4.0 * r.covariance(1, 1));
}

/// A corridor with a pilaster every 0.75 m: shifted by that it is the same again.
struct Colonnade {
  double operator()(double x_m, double y_m) const {
    const double reach_m = std::fmod(x_m + 75.0, 0.75) < 0.375 ? 1.6 : 2.0;
    return std::abs(y_m) > reach_m ? 0.6 : 0.0;
  }
};

TEST(Registration, WhereSeveralPlacesMatchTellsOnlyWhatTheyAgreeOn) {
  const Registration r =
      registered(Colonnade{}, {0.35, 0.3, 0.1, 0.0, 0.0, radians(2.0)}, {}, 1, 1.0);
  ASSERT_TRUE(r.accepted) << r.why;
  EXPECT_LT(r.margin, RegistrationConfig{}.min_margin);
  EXPECT_FALSE(r.position_observable);
  EXPECT_NEAR(r.T_site_submap.y_m, kRobot.y_m, 0.05);
  EXPECT_NEAR(r.T_site_submap.z_m, kRobot.z_m, 0.02);
  EXPECT_NEAR(r.T_site_submap.x_m, kRobot.x_m + 0.35, 0.1) << "along the row the prior stays";
  EXPECT_GT(r.covariance(0, 0), 0.3 * 0.3);
}

TEST(Registration, WhereSeveralPlacesMatchAnswersWithACovariance) {
  for (int i = 0; i < 4; ++i) {
    const Registration r =
        registered(Colonnade{}, {0.1 * i, 0.3, 0.1, 0.0, 0.0, radians(2.0)}, {}, 1, 1.0);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(r.covariance);
    EXPECT_GT(eigen.eigenvalues().minCoeff(), 0.0) << r.covariance;
    EXPECT_TRUE(r.covariance.isApprox(r.covariance.transpose(), 1e-6)) << r.covariance;
  }
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
  const HeightMap long_term = test::long_term_of(ground, random);
  const Registration r =
      register_map(test::short_term_of(ground, kRobot, random), prior, long_term, {});
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

/// A world of random boxes on random waves.
struct RandomGround {
  explicit RandomGround(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-7.0, 7.0);
    std::uniform_real_distribution<double> size(0.3, 1.0);
    for (int i = 0; i < 25; ++i) {
      boxes.push_back({place(random), place(random), size(random), size(random)});
    }
  }
  double operator()(double x, double y) const {
    double height = 0.1 * std::sin(0.8 * x + boxes.front().x) * std::cos(0.6 * y);
    for (const Box& box : boxes) {
      if (std::abs(x - box.x) < box.size && std::abs(y - box.y) < box.size) height += box.height;
    }
    return height;
  }
  struct Box {
    double x, y, size, height;
  };
  std::vector<Box> boxes;
};

/// The ground as a robot maps it that takes itself for level and stands nose down.
struct Tipped {
  test::RichGround ground;
  double operator()(double x_m, double y_m) const {
    return ground(x_m, y_m) + 0.025 * (x_m - kRobot.x_m);
  }
};

TEST(Registration, OfAMapMadeOnARockingRobotContradictsAndTellsLess) {
  std::mt19937_64 random(3);
  const HeightMap long_term = test::long_term_of(test::RichGround{}, random, 0.8);
  const HeightMap short_term = test::short_term_of(Tipped{}, kRobot, random);
  RegistrationPrior prior;
  prior.T_site_submap = {kRobot.x_m, kRobot.y_m, kRobot.z_m, 0.0, 0.0, kRobot.yaw_rad};
  prior.covariance = test::sigmas(0.4, radians(5.0));
  RegistrationConfig config;
  config.widen = false;
  const Registration sure = register_map(short_term, prior, long_term, config);
  EXPECT_FALSE(sure.accepted);
  prior.incline_sigma_rad = 0.04;
  const Registration unsure = register_map(short_term, prior, long_term, config);
  EXPECT_LT(unsure.misfit, 0.5 * sure.misfit);
  EXPECT_GT(unsure.inliers, sure.inliers);
  EXPECT_LT(unsure.information(2, 2), 0.5 * sure.information(2, 2));
  EXPECT_TRUE(unsure.supports_prior);
}

TEST(Registration, OfAMapWithItselfDisplacedReturnsTheDisplacement) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> one(-1.0, 1.0);
    const HeightMap map = test::short_term_of(RandomGround(seed), Pose{}, random);
    RegistrationPrior prior;
    prior.T_site_submap = {
        0.6 * one(random),         0.6 * one(random), 0.2 * one(random), 0.0, 0.0,
        radians(6.0) * one(random)};
    prior.covariance = test::sigmas(0.4, radians(5.0));
    const Registration r = register_map(map, prior, map, {});
    ASSERT_TRUE(r.accepted) << r.why << ", seed " << seed;
    EXPECT_NEAR(r.T_site_submap.x_m, 0.0, 0.01) << "seed " << seed;
    EXPECT_NEAR(r.T_site_submap.y_m, 0.0, 0.01) << "seed " << seed;
    EXPECT_NEAR(r.T_site_submap.z_m, 0.0, 0.01) << "seed " << seed;
    EXPECT_NEAR(r.T_site_submap.yaw_rad, 0.0, radians(0.2)) << "seed " << seed;
  }
}

TEST(Registration, RefusesMapsThatDoNotMeetTheLongTermMap) {
  std::mt19937_64 random(2);
  const HeightMap map = test::short_term_of(test::RichGround{}, kRobot, random);
  RegistrationPrior prior;
  prior.T_site_submap = {500.0, -300.0};
  const Registration r =
      register_map(map, prior, test::long_term_of(test::RichGround{}, random), {});
  EXPECT_FALSE(r.accepted);
  EXPECT_EQ(r.T_site_submap.x_m, 500.0);
  EXPECT_FALSE(r.why.empty());
}

TEST(Registration, RefusesAPriorWhoseCovarianceIsNone) {
  std::mt19937_64 random(3);
  const HeightMap map = test::short_term_of(test::RichGround{}, kRobot, random);
  RegistrationPrior prior;
  prior.T_site_submap = kRobot;
  prior.covariance(1, 1) = -1.0;
  EXPECT_EQ(register_map(map, prior, map, {}).why, "the prior's covariance is none");
  prior.covariance(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(register_map(map, prior, map, {}).why, "the prior is not finite");
}

TEST(Registration, ARefusedAnswerLeavesTheRobotWhereThePriorHasIt) {
  RegistrationPrior prior;
  prior.T_site_submap = kRobot;
  prior.T_submap_robot = {0.5, 0.25, 0.1, 0.0, 0.0, radians(10.0)};
  const HeightMap empty(test::kCellMm);
  const Registration r = register_map(empty, prior, empty, {});
  EXPECT_NEAR(r.T_site_robot.yaw_rad, kRobot.yaw_rad + radians(10.0), 1e-9);
  EXPECT_NEAR(r.T_site_robot.z_m, kRobot.z_m + 0.1, 1e-9);
  EXPECT_EQ(r.covariance, prior.covariance);
}

TEST(Registration, OfOneCellIsRefused) {
  HeightMap speck(test::kCellMm);
  speck.set({0, 0}, {100, 200});
  EXPECT_FALSE(register_map(speck, {}, speck, {}).accepted);
}

}  // namespace
}  // namespace cairn
