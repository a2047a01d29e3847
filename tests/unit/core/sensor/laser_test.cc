#include "core/sensor/laser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace cairn {
namespace {

using Eigen::Vector3d;

constexpr double kFreeRange = 8.0;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

void expect_near(const Vector3d& actual, const Vector3d& expected) {
  EXPECT_LT((actual - expected).norm(), 1e-6)
      << "is " << actual.transpose() << ", should be " << expected.transpose();
}

LaserSpec three_beams() {
  LaserSpec spec;
  spec.beam_count = 3;
  spec.step_rad = radians(90);
  return spec;
}

TEST(Laser, TheAtrvJrCarriesOneLevelAndOneLooking22DegreesDown) {
  const std::vector<LaserSpec> lasers = atrv_jr_lasers();
  ASSERT_EQ(lasers.size(), 2U);
  for (const LaserSpec& laser : lasers) {
    EXPECT_EQ(laser.beam_count, 181);
    EXPECT_NEAR(laser.first_angle_rad + 180 * laser.step_rad, radians(90), 1e-12);
  }
  EXPECT_EQ(lasers[0].T_robot_sensor.pitch_rad, 0.0);
  EXPECT_EQ(lasers[1].T_robot_sensor.pitch_rad, radians(22));
}

TEST(Laser, BeamsRunFromRightToLeft) {
  const std::vector<Beam> beams =
      beams_in_site({.range_m = {1, 2, 3}}, three_beams(), Pose{}, kFreeRange);
  ASSERT_EQ(beams.size(), 3U);
  expect_near(beams[0].end_m, {0, -1, 0});
  expect_near(beams[1].end_m, {2, 0, 0});
  expect_near(beams[2].end_m, {0, 3, 0});
}

TEST(Laser, PlacesPointsByThePoseOfTheRobotAndOfTheSensorOnIt) {
  // Equations (9) and (10) by hand. The sensor looks 30° down from (1, 0, 2) on the robot; the
  // robot stands at (10, 20, 5) and faces +y.
  LaserSpec spec = three_beams();
  spec.T_robot_sensor = {.x_m = 1, .z_m = 2, .pitch_rad = radians(30)};
  const Pose T_site_robot{.x_m = 10, .y_m = 20, .z_m = 5, .yaw_rad = radians(90)};
  const std::vector<Beam> beams =
      beams_in_site({.range_m = {4, 2, 4}}, spec, T_site_robot, kFreeRange);
  ASSERT_EQ(beams.size(), 3U);
  for (const Beam& beam : beams) expect_near(beam.origin_m, {10, 21, 7});
  expect_near(beams[1].end_m, {10, 21 + 2 * std::cos(radians(30)), 7 - 2 * std::sin(radians(30))});
  expect_near(beams[0].end_m, {14, 21, 7});  // To the robot's right: +x; level, as pitch tilts
  expect_near(beams[2].end_m, {6, 21, 7});   // around the sensor's y axis.
}

TEST(Laser, ARobotNoseUpBy22DegreesLevelsItsTiltedLaser) {
  const LaserSpec tilted = atrv_jr_lasers()[1];
  std::vector<float> ranges(181, 5.0F);
  const std::vector<Beam> beams =
      beams_in_site({.range_m = ranges}, tilted, Pose{.pitch_rad = radians(-22)}, kFreeRange);
  for (const Beam& beam : beams) EXPECT_NEAR(beam.end_m.z(), beam.origin_m.z(), 1e-9);
}

TEST(Laser, NoReturnIsAFreeBeamAsLongAsEmptinessIsBelieved) {
  for (const float none : {30.0F, 81.0F, kInfinite}) {
    const std::vector<Beam> beams =
        beams_in_site({.range_m = {1, none, 1}}, three_beams(), Pose{}, kFreeRange);
    ASSERT_EQ(beams.size(), 3U);
    EXPECT_TRUE(beams[0].hit);
    EXPECT_FALSE(beams[1].hit);
    expect_near(beams[1].end_m, {kFreeRange, 0, 0});
  }
}

TEST(Laser, LeavesOutReadingsBelowMinRangeAndThoseThatAreNotNumbers) {
  for (const float bad : {0.0F, 0.05F, -1.0F, kNan, -kInfinite}) {
    const std::vector<Beam> beams =
        beams_in_site({.range_m = {1, bad, 3}}, three_beams(), Pose{}, kFreeRange);
    ASSERT_EQ(beams.size(), 2U) << bad;
    expect_near(beams[1].end_m, {0, 3, 0});
  }
}

TEST(Laser, IgnoresRangesBeyondItsBeams) {
  const Scan scan{.range_m = std::vector<float>(500, 1.0F)};
  EXPECT_EQ(beams_in_site(scan, three_beams(), Pose{}, kFreeRange).size(), 3U);
}

TEST(Laser, TakesShortScansAsTheyAre) {
  EXPECT_EQ(beams_in_site({.range_m = {1}}, three_beams(), Pose{}, kFreeRange).size(), 1U);
  EXPECT_TRUE(beams_in_site({}, three_beams(), Pose{}, kFreeRange).empty());
}

TEST(Laser, ANegativeStepTurnsClockwise) {
  LaserSpec spec = three_beams();
  spec.first_angle_rad = radians(90);
  spec.step_rad = radians(-90);
  const std::vector<Beam> beams = beams_in_site({.range_m = {1, 1, 1}}, spec, Pose{}, kFreeRange);
  expect_near(beams[0].end_m, {0, 1, 0});
  expect_near(beams[2].end_m, {0, -1, 0});
}

}  // namespace
}  // namespace cairn
