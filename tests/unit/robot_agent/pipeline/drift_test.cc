#include "robot_agent/pipeline/drift.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn::agent {
namespace {

/// Straight on along x; `look`: what local tracking tells after each step.
Drift after_way(double way_m, const std::optional<Eigen::Matrix3d>& look) {
  Drift drift{DeadReckoningConfig{}};
  drift.start(Eigen::Matrix4d::Zero());
  for (double x_m = 0.1; x_m < way_m + 0.05; x_m += 0.1) {
    drift.add({.x_m = x_m - 0.1}, {.x_m = x_m}, 0.2);
    if (look) drift.track({.x_m = x_m}, *look, true);
  }
  return drift;
}

double sigma_m(const Drift& drift, int i) { return std::sqrt(drift.covariance()(i, i)); }

const Eigen::Matrix3d kWalls = Eigen::Vector3d(2e4, 2e4, 2e5).asDiagonal();
const Eigen::Matrix3d kCorridor = Eigen::Vector3d(0.0, 2e4, 2e5).asDiagonal();

TEST(Drift, GrowsInProportionToTheWayByDeadReckoning) {
  EXPECT_NEAR(sigma_m(after_way(10.0, {}), 0), 0.2, 0.02);  // 2 % slip.
  EXPECT_NEAR(sigma_m(after_way(20.0, {}), 0), 0.4, 0.04);
}

TEST(Drift, GrowsFarLessBetweenWalls) {
  const Drift drift = after_way(10.0, kWalls);
  EXPECT_LT(sigma_m(drift, 0), 0.1);
  EXPECT_LT(sigma_m(drift, 1), 0.1);
  EXPECT_GT(sigma_m(drift, 0), 0.005);
}

TEST(Drift, GrowsAlongACorridorAsWithoutTracking) {
  const Drift drift = after_way(10.0, kCorridor);
  EXPECT_GT(sigma_m(drift, 0), 0.1);
  EXPECT_LT(sigma_m(drift, 1), 0.1);
}

TEST(Drift, StandsStillWithTheRobot) {
  Drift drift = after_way(5.0, kWalls);
  const double before_m = sigma_m(drift, 0);
  for (int i = 0; i < 1000; ++i) drift.track({.x_m = 5.0}, kWalls, false);
  EXPECT_NEAR(sigma_m(drift, 0), before_m, 0.01);
}

TEST(Drift, CarriesAWrongHeadingSideways) {
  Drift drift{DeadReckoningConfig{}};
  drift.start(Eigen::Vector4d(0.0, 0.0, 0.0, 0.01).asDiagonal());
  drift.add({}, {.x_m = 1.0}, 1.0);
  EXPECT_NEAR(sigma_m(drift, 1), 0.1, 0.01);
}

}  // namespace
}  // namespace cairn::agent
