#include "robot_agent/input/simulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "robot_agent/input/paint.h"

namespace cairn::agent {
namespace {

MonotonicTime stamp_of(const Reading& reading) {
  return std::visit([](const auto& r) { return r.stamp; }, reading);
}

std::unique_ptr<Input> simulator(const SimulatorConfig& config) {
  auto made = make_simulator(config);
  EXPECT_TRUE(made) << made.error().message;
  return std::move(*made);
}

World plain() {
  World world{"plain", HeightRaster(0.5, 161, 161, -40, -40), {}};
  return world;
}

std::vector<Reading> advance(Input& input, double until_s) {
  auto readings = input.advance(from_seconds(until_s));
  EXPECT_TRUE(readings);
  return std::move(*readings);
}

// All that was read, as bytes.
std::string bytes_of(const std::vector<Reading>& readings) {
  std::string bytes;
  const auto add = [&bytes](double value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof raw);
  };
  for (const Reading& reading : readings) {
    add(to_seconds(stamp_of(reading)));
    if (const auto* motion = std::get_if<MotionReading>(&reading)) {
      for (const double value : {motion->odometer_x_m, motion->odometer_y_m,
                                 motion->odometer_yaw_rad, motion->gyro_yaw_rate_rad_s,
                                 motion->inclinometer_roll_rad, motion->inclinometer_pitch_rad}) {
        add(value);
      }
    } else {
      for (const float range : std::get<Scan>(reading).range_m) {
        add(range);
      }
    }
  }
  return bytes;
}

TEST(Simulator, BeginsWithAMotionReadingAtTimeZeroAndKeepsTheOrderOfStamps) {
  const auto input = simulator({});
  EXPECT_EQ(input->next_stamp(), MonotonicTime{0});
  const auto readings = advance(*input, 1.0);
  ASSERT_TRUE(std::holds_alternative<MotionReading>(readings.front()));
  EXPECT_EQ(stamp_of(readings.front()), MonotonicTime{0});
  MonotonicTime last{0};
  int motions = 0;
  int scans = 0;
  for (const Reading& reading : readings) {
    EXPECT_GE(stamp_of(reading), last);
    last = stamp_of(reading);
    (std::holds_alternative<Scan>(reading) ? scans : motions) += 1;
  }
  EXPECT_EQ(motions, 21);
  EXPECT_EQ(scans, 2 * 6);
  EXPECT_EQ(input->next_stamp(), from_seconds(1.05));
}

TEST(Simulator, ReadsTheSameBitForBitHoweverItsTimeIsCutUp) {
  SimulatorConfig config;
  config.seed = 42;
  const auto whole = simulator(config);
  const auto pieces = simulator(config);
  whole->drive({0.5, 0.2});
  pieces->drive({0.5, 0.2});
  const auto expected = advance(*whole, 3.0);
  std::vector<Reading> found;
  for (double t = 0.0; t < 3.0; t += 0.013) {
    const auto more = advance(*pieces, t);
    found.insert(found.end(), more.begin(), more.end());
  }
  const auto rest = advance(*pieces, 3.0);
  found.insert(found.end(), rest.begin(), rest.end());
  EXPECT_TRUE(bytes_of(expected) == bytes_of(found));
  config.seed = 43;
  EXPECT_FALSE(bytes_of(expected) == bytes_of(advance(*simulator(config), 3.0)));
}

TEST(Simulator, SeesFlatGroundWithTheTiltedLaserAtItsAnalyticDistance) {
  auto made = make_simulator({}, plain());
  ASSERT_TRUE(made);
  const LaserSpec& tilted = (*made)->lasers()[1];
  const double expected = tilted.T_robot_sensor.z_m / std::sin(tilted.T_robot_sensor.pitch_rad);
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  for (const Reading& reading : advance(**made, 40.0)) {
    const auto* scan = std::get_if<Scan>(&reading);
    if (scan != nullptr && scan->laser == 1) {
      const double error = double{scan->range_m[90]} - expected;
      if (std::abs(error) < 1.0) {
        sum += error;
        squares += error * error;
        ++count;
      }
    }
  }
  EXPECT_GT(count, 190) << "dropouts are rare";
  EXPECT_NEAR(sum / count, 0.0, 0.005);
  EXPECT_NEAR(std::sqrt(squares / count), 0.015, 0.003);
}

TEST(Simulator, TellsNoReturnByTheMaximumRange) {
  auto made = make_simulator({}, plain());
  ASSERT_TRUE(made);
  for (const Reading& reading : advance(**made, 1.0)) {
    if (const auto* scan = std::get_if<Scan>(&reading); scan != nullptr && scan->laser == 0) {
      for (const float range : scan->range_m) {
        EXPECT_EQ(range, 30.0F);
      }
    }
  }
}

TEST(Simulator, DrivesOnItsLastCommandAndTellsTheTruth) {
  auto made = make_simulator({}, plain());
  ASSERT_TRUE(made);
  Input& input = **made;
  EXPECT_TRUE(input.can_drive());
  EXPECT_FALSE(input.finished());
  advance(input, 1.0);
  EXPECT_EQ(input.truth()->T_site_robot.x_m, 0.0);
  input.drive({0.5, 0.0});
  advance(input, 11.0);
  EXPECT_NEAR(input.truth()->T_site_robot.x_m, 4.83, 0.05);
  EXPECT_EQ(input.truth()->collisions, 0);
  input.drive({});
  advance(input, 12.0);
  const double stopped = input.truth()->T_site_robot.x_m;
  advance(input, 20.0);
  EXPECT_EQ(input.truth()->T_site_robot.x_m, stopped);
}

TEST(Simulator, RefusesAFaultyConfigurationAndNamesEachFault) {
  SimulatorConfig config;
  config.scan_rate_hz = 0.0;
  config.lasers.dropout_probability = 2.0;
  const auto made = make_simulator(config);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().message.find("scan_rate_hz"), std::string::npos);
  EXPECT_NE(made.error().message.find("dropout_probability"), std::string::npos);
  config = {};
  config.world = "nowhere";
  EXPECT_FALSE(make_simulator(config));
}

}  // namespace
}  // namespace cairn::agent
