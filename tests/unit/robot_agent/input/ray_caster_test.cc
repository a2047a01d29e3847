#include "robot_agent/input/ray_caster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/common/angle.h"
#include "robot_agent/input/noise.h"
#include "robot_agent/input/paint.h"

namespace cairn::agent {
namespace {

Eigen::Vector3d heading(double yaw_rad, double down_rad = 0.0) {
  return {std::cos(yaw_rad) * std::cos(down_rad), std::sin(yaw_rad) * std::cos(down_rad),
          -std::sin(down_rad)};
}

// Flat, 20 × 20 m around the origin.
HeightRaster flat() { return {0.05, 401, 401, -10.0, -10.0}; }

TEST(RayCaster, FindsAWallAtItsAnalyticDistanceInEveryDirection) {
  HeightRaster surface = flat();
  paint(surface, 5.0, -10.0, 6.0, 10.0, [](double, double, double) { return 2.0; });
  const RayCaster caster(surface);
  for (double yaw = radians(-60); yaw <= radians(60); yaw += radians(1)) {
    // The wall rises over the cell before its edge: at 0.4 m of 2 m it is a fifth of a cell in.
    const double expected = (4.95 + 0.2 * 0.05) / std::cos(yaw);
    EXPECT_NEAR(caster.range_m({0, 0, 0.4}, heading(yaw), 30.0), expected, 0.001) << degrees(yaw);
  }
}

TEST(RayCaster, MeetsFlatGroundWhereATiltedLaserShould) {
  const HeightRaster surface = flat();
  const RayCaster caster(surface);
  EXPECT_NEAR(caster.range_m({0, 0, 0.75}, heading(0.3, radians(22)), 30.0),
              0.75 / std::sin(radians(22)), 1e-6);
  EXPECT_NEAR(caster.range_m({0.01, 0.02, 3.0}, {0, 0, -1}, 30.0), 3.0, 1e-6);
}

TEST(RayCaster, LooksOverWhatIsLowerThanTheRay) {
  HeightRaster surface = flat();
  paint(surface, 2.0, -10.0, 3.0, 10.0, [](double, double, double) { return 0.39; });
  const RayCaster caster(surface);
  EXPECT_EQ(caster.range_m({0, 0, 0.4}, heading(0.0), 8.0), 8.0);
}

TEST(RayCaster, TakesTheEndOfTheRasterAsAWall) {
  const HeightRaster surface = flat();
  const RayCaster caster(surface);
  EXPECT_NEAR(caster.range_m({0, 0, 0.4}, heading(0.0), 30.0), 10.0, 0.001);
  EXPECT_EQ(caster.range_m({50, 0, 0.4}, heading(0.0), 30.0), 0.0);
}

TEST(RayCaster, RunsAlongTheBordersOfCellsWithoutBeingCaught) {
  const HeightRaster surface = flat();
  const RayCaster caster(surface);
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double yaw = quarter * 0.5 * std::numbers::pi;  // Its sine is 1e-16, not 0.
    EXPECT_NEAR(caster.range_m({0, 0, 0.4}, heading(yaw), 30.0), 10.0, 0.001) << quarter;
  }
}

TEST(RayCaster, AgreesWithSmallStepsOnRoughGround) {
  Noise noise(7, 0);
  HeightRaster surface(0.1, 201, 181, -10.0, -9.0);
  Hills hills(4.0, 0.8, 4, noise);
  paint_all(surface, [&](double x, double y, double) { return hills.height_m(x, y); });
  const RayCaster caster(surface);
  constexpr double kStepM = 0.0005;
  for (int i = 0; i < 300; ++i) {
    const double x = noise.uniform(-5, 5);
    const double y = noise.uniform(-5, 5);
    const Eigen::Vector3d origin(x, y, surface.height_m(x, y) + 0.5);
    const Eigen::Vector3d direction = heading(noise.uniform(-3, 3), noise.uniform(-0.1, 0.4));
    double expected = 0.0;
    Eigen::Vector3d p = origin;
    while (expected < 12.0 && p.z() > surface.height_m(p.x(), p.y())) {
      expected += kStepM;
      p = origin + expected * direction;
    }
    EXPECT_NEAR(caster.range_m(origin, direction, 12.0), std::min(expected, 12.0), 0.005)
        << "ray " << i << " of seed 7";
  }
}

}  // namespace
}  // namespace cairn::agent
