#include "robot_agent/input/instruments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robot_agent/input/paint.h"

namespace cairn::agent {
namespace {

constexpr double kTickS = 0.01;

struct Drift {
  double odometer_deg, gyro_deg;
};

// 32 m at 0.5 m/s with 360° of turning, as around the room: a circle of 5.1 m.
Drift lap(std::uint64_t seed) {
  const HeightRaster surface(0.5, 41, 41, -10, -10);
  VehicleConfig sure;
  sure.slip = 0.0;
  Vehicle vehicle(sure, surface, {.x_m = 0, .y_m = -5});
  Instruments instruments({}, seed, vehicle.pose());
  (void)instruments.read(MonotonicTime{0});
  double gyro_rad = 0.0;
  double odometer_rad = 0.0;
  double turned_rad = 0.0;
  double before_rad = 0.0;
  for (int tick = 1; tick <= 6400; ++tick) {
    vehicle.step({0.5, 2 * std::numbers::pi / 64.0}, kTickS);
    instruments.follow(vehicle, kTickS);
    turned_rad += vehicle.turn_rate_rad_s() * kTickS;
    if (tick % 5 == 0) {
      const MotionReading reading = instruments.read(MonotonicTime{tick * 10'000});
      gyro_rad += reading.gyro_yaw_rate_rad_s * 5 * kTickS;
      odometer_rad += wrap_angle(reading.odometer_yaw_rad - before_rad);
      before_rad = reading.odometer_yaw_rad;
    }
  }
  return {std::abs(degrees(odometer_rad - turned_rad)), std::abs(degrees(gyro_rad - turned_rad))};
}

TEST(Instruments, DriftOnALapAsTheThesisReports) {
  constexpr int kRobots = 30;
  double odometer = 0.0;
  double gyro = 0.0;
  for (std::uint64_t seed = 1; seed <= kRobots; ++seed) {
    const Drift drift = lap(seed);
    EXPECT_GT(drift.odometer_deg, 15.0) << "seed " << seed;
    EXPECT_LT(drift.gyro_deg, 15.0) << "seed " << seed;
    odometer += drift.odometer_deg / kRobots;
    gyro += drift.gyro_deg / kRobots;
  }
  EXPECT_NEAR(odometer, 40.0, 8.0);
  EXPECT_NEAR(gyro, 5.0, 2.0);
}

TEST(Instruments, LetTheInclinometerSettleToFivePercentInThreeSeconds) {
  HeightRaster level(0.5, 41, 41, -10, -10);
  HeightRaster slope = level;
  paint_all(slope, [](double x, double, double) { return 0.1 * x; });
  InstrumentConfig config;
  config.inclinometer_sigma_rad = 0.0;
  Instruments instruments(config, 1, Vehicle({}, level, {}).pose());
  const Vehicle tilted({}, slope, {});
  for (int tick = 0; tick < 300; ++tick) {
    instruments.follow(tilted, kTickS);
  }
  const double pitch = instruments.read(MonotonicTime{0}).inclinometer_pitch_rad;
  EXPECT_NEAR(pitch / tilted.pose().pitch_rad, 0.95, 0.002);
}

TEST(Instruments, MeasureTheWheelsTravelNotTheRobots) {
  const HeightRaster surface(0.5, 41, 41, -10, -10);
  VehicleConfig slippery;
  slippery.slip = 0.2;
  InstrumentConfig exact;
  exact.odometer_distance_scale = 0.0;
  exact.odometer_yaw_drift_rad_per_m = 0.0;
  Vehicle vehicle(slippery, surface, {});
  Instruments instruments(exact, 1, vehicle.pose());
  for (int tick = 0; tick < 600; ++tick) {
    vehicle.step({0.5, 0.0}, kTickS);
    instruments.follow(vehicle, kTickS);
  }
  EXPECT_NEAR(vehicle.pose().x_m / instruments.read(MonotonicTime{0}).odometer_x_m, 0.8, 1e-6);
}

}  // namespace
}  // namespace cairn::agent
