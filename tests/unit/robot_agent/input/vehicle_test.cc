#include "robot_agent/input/vehicle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/common/angle.h"
#include "robot_agent/input/paint.h"

namespace cairn::agent {
namespace {

HeightRaster flat() { return {0.025, 801, 401, 0.0, -5.0}; }  // x 0 … 20, y -5 … 5.

void drive(Vehicle& vehicle, double speed_m_s, double turn_rate_rad_s, double seconds) {
  for (int tick = 0; tick < seconds * 100; ++tick) {
    vehicle.step({speed_m_s, turn_rate_rad_s}, 0.01);
  }
}

TEST(Vehicle, AcceleratesWithinItsLimits) {
  const HeightRaster surface = flat();
  Vehicle vehicle({}, surface, {.x_m = 2});
  drive(vehicle, 5.0, 0.0, 0.5);
  EXPECT_NEAR(vehicle.wheel_speed_m_s(), 0.5, 0.02);
  drive(vehicle, 5.0, 0.0, 2.0);
  EXPECT_DOUBLE_EQ(vehicle.wheel_speed_m_s(), 1.0);
}

TEST(Vehicle, StopsAtAWallAndCountsOneCollisionHoweverLongItPushes) {
  HeightRaster surface = flat();
  paint(surface, 8.0, -5.0, 9.0, 5.0, [](double, double, double) { return 2.0; });
  Vehicle vehicle({}, surface, {.x_m = 5});
  drive(vehicle, 0.5, 0.0, 20.0);
  EXPECT_EQ(vehicle.collisions(), 1);
  EXPECT_NEAR(vehicle.pose().x_m, 8.0 - 0.39, 0.04);
}

TEST(Vehicle, CountsASecondCollisionAfterBackingOff) {
  HeightRaster surface = flat();
  paint(surface, 8.0, -5.0, 9.0, 5.0, [](double, double, double) { return 2.0; });
  Vehicle vehicle({}, surface, {.x_m = 7});
  drive(vehicle, 0.5, 0.0, 3.0);
  drive(vehicle, -0.5, 0.0, 2.0);
  EXPECT_LT(vehicle.pose().x_m, 7.2);
  drive(vehicle, 0.5, 0.0, 4.0);
  EXPECT_EQ(vehicle.collisions(), 2);
}

TEST(Vehicle, ClimbsAStepBelowItsLimitAndNotOneAboveIt) {
  for (const double step : {0.08, 0.13}) {
    HeightRaster surface = flat();
    paint(surface, 8.0, -5.0, 20.0, 5.0, [=](double, double, double) { return step; });
    Vehicle vehicle({}, surface, {.x_m = 6});
    drive(vehicle, 0.5, 0.0, 10.0);
    EXPECT_EQ(vehicle.collisions(), step > 0.1 ? 1 : 0) << step;
    EXPECT_EQ(vehicle.pose().x_m > 9.0, step < 0.1) << step;
  }
}

TEST(Vehicle, CountsADropBelowItsLimitAndStaysUp) {
  HeightRaster surface = flat();
  paint(surface, 8.0, -5.0, 20.0, 5.0, [](double, double, double) { return -1.0; });
  Vehicle vehicle({}, surface, {.x_m = 6});
  drive(vehicle, 0.5, 0.0, 10.0);
  EXPECT_EQ(vehicle.collisions(), 1);
  EXPECT_GT(vehicle.pose().z_m, -0.1);
  drive(vehicle, -0.5, 0.0, 4.0);
  EXPECT_LT(vehicle.pose().x_m, 7.0) << "it can back off the edge";
}

TEST(Vehicle, RaisesItsNoseWithNegativePitchOnTheWayUp) {
  HeightRaster surface = flat();
  const double slope = std::tan(radians(8));
  paint_all(surface, [=](double x, double y, double) { return slope * x + 0.05 * y; });
  Vehicle vehicle({}, surface, {.x_m = 5});
  EXPECT_NEAR(degrees(vehicle.pose().pitch_rad), -8.0, 0.3);
  EXPECT_NEAR(vehicle.pose().roll_rad, std::atan(0.05), 0.005);
  EXPECT_NEAR(vehicle.pose().z_m, slope * 5, 0.02);
}

TEST(Vehicle, TouchesWithItsCornersWhenTurning) {
  HeightRaster surface = flat();
  paint(surface, 0.0, 0.40, 20.0, 1.0, [](double, double, double) { return 1.0; });
  Vehicle vehicle({}, surface, {.x_m = 5});
  EXPECT_TRUE(vehicle.stands_free(5, 0, 0));
  EXPECT_FALSE(vehicle.stands_free(5, 0, radians(45)));
  drive(vehicle, 0.0, 0.5, 5.0);
  EXPECT_EQ(vehicle.collisions(), 1);
}

TEST(Vehicle, DoesNotTipOver) {
  HeightRaster surface = flat();
  paint(surface, 8.0, -5.0, 20.0, 5.0, [](double x, double, double) { return x - 8.0; });
  Vehicle vehicle({}, surface, {.x_m = 6});
  drive(vehicle, 0.5, 0.0, 20.0);
  EXPECT_GE(vehicle.collisions(), 1);
  EXPECT_LE(std::abs(vehicle.pose().pitch_rad), 0.61);
}

TEST(Vehicle, NeverLeavesTheRaster) {
  const HeightRaster surface = flat();
  Vehicle vehicle({}, surface, {.x_m = 18});
  drive(vehicle, 1.0, 0.0, 10.0);
  EXPECT_LT(vehicle.pose().x_m, 20.0);
  EXPECT_EQ(vehicle.collisions(), 1);
}

TEST(Vehicle, TakesACommandThatIsNotANumberAsStop) {
  const HeightRaster surface = flat();
  Vehicle vehicle({}, surface, {.x_m = 5});
  drive(vehicle, std::nan(""), std::nan(""), 1.0);
  EXPECT_EQ(vehicle.pose().x_m, 5.0);
}

TEST(VehicleConfig, NamesEveryFault) {
  VehicleConfig config;
  config.climb_limit_m = -1;
  config.slip = std::nan("");
  EXPECT_NE(faults(config).find("climb_limit_m"), std::string::npos);
  EXPECT_NE(faults(config).find("slip"), std::string::npos);
  EXPECT_EQ(faults(VehicleConfig{}), "");
}

}  // namespace
}  // namespace cairn::agent
