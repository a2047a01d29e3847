#include "robot_agent/pipeline/mapper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/robot_agent/pipeline/mapping_robot.h"

namespace cairn::agent {
namespace {

using namespace testing;  // NOLINT: the robot and its world
using proto::testing::delivered;

/// A blind robot: only its wheels know the ground.
std::vector<LaserSpec> no_lasers() { return {}; }

// ---- Heights ------------------------------------------------------------------------------------

TEST(Mapper, MapsFlatGroundFlat) {
  MappingRobot robot;
  robot.forward(3.0);
  for (double x_m = -0.2; x_m < 4.0; x_m += 0.125) {
    ASSERT_TRUE(robot.at(x_m, 0.0).known()) << x_m;
    EXPECT_NEAR(robot.at(x_m, 0.0).height_mm, 0, 5) << x_m;
  }
}

TEST(Mapper, MapsAWallAsHighAsItsBeamsHitIt) {
  MappingRobot robot;
  robot.scene.boxes = {box(4.0, 4.5, -2.0, 2.0, 1.0)};
  robot.forward(2.0);
  EXPECT_NEAR(robot.at(4.05, 0.3).height_mm, 400, 10);  // The level laser's height.
}

TEST(Mapper, MapsTheTopOfAKerbBelowTheLevelLaser) {
  MappingRobot robot;
  robot.scene.boxes = {box(3.0, 5.0, -2.0, 2.0, 0.15)};
  robot.forward(2.2);
  EXPECT_NEAR(robot.at(3.5, 0.0).height_mm, 150, 10);
  EXPECT_NEAR(robot.at(2.7, 0.0).height_mm, 0, 10);
}

TEST(Mapper, MapsGroundHighAboveTheSitesOrigin) {
  MappingRobot robot({}, {.x_m = 100.0, .y_m = -50.0, .z_m = 812.3});
  robot.forward(3.0);
  EXPECT_NEAR(robot.at(103.0, -50.0).height_mm, 812'300, 5);
}

TEST(Mapper, MapsTheSameWhicheverWayItFaces) {
  MappingRobot robot({}, {.yaw_rad = radians(135.0)});
  robot.scene.boxes = {box(-3.6, -3.0, 2.0, 4.0, 0.15)};
  robot.forward(3.2);
  EXPECT_NEAR(robot.at(-3.3, 3.3).height_mm, 150, 10);
  EXPECT_NEAR(robot.at(-1.0, 1.0).height_mm, 0, 10);
}

TEST(Mapper, DoesNotMapHitsBeyondItsRange) {
  MapperConfig config;
  config.mapping_range_m = 5.0;
  MappingRobot robot(config);
  robot.scene.boxes = {box(8.0, 9.0, -2.0, 2.0, 1.0)};
  robot.look();
  EXPECT_FALSE(robot.at(8.05, 0.0).known());
}

TEST(Mapper, LeavesTheUnseenUnknown) {
  MappingRobot robot;
  robot.scene.boxes = {box(4.0, 4.5, -2.0, 2.0, 1.0)};
  robot.forward(1.0);
  EXPECT_FALSE(robot.at(6.0, 0.0).known());   // Behind the wall,
  EXPECT_FALSE(robot.at(-3.0, 0.0).known());  // and behind the robot.
}

TEST(Mapper, TakesTheWayOfALevelBeamAsGroundWhenTheLogSaysSo) {
  LaserSpec planar = atrv_jr_lasers()[0];
  planar.ground_along_beam = true;
  MappingRobot robot({}, {}, {planar});
  robot.scene.boxes = {box(4.0, 4.5, -2.0, 2.0, 1.0)};
  robot.look();
  EXPECT_EQ(robot.at(2.5, 0.0).height_mm, 0);
  EXPECT_TRUE(robot.at(2.5, 0.0).known());
  EXPECT_NEAR(robot.at(4.05, 0.0).height_mm, 400, 1);
}

TEST(Mapper, IgnoresAScanOfALaserItDoesNotHave) {
  MappingRobot robot({}, {}, no_lasers());
  robot.mapper.take_scan({.laser = 3, .range_m = {1.0F, 2.0F}});
  EXPECT_EQ(robot.mapper.beams(), 0);
}

// ---- Under the robot ----------------------------------------------------------------------------

TEST(Mapper, KnowsTheGroundUnderItsWheels) {
  MappingRobot robot({}, {}, no_lasers());
  robot.roll_blindly(2.0);
  for (double x_m = 0.0; x_m < 2.0; x_m += 0.125) {
    for (const double y_m : {-0.2, 0.0, 0.2}) {
      EXPECT_TRUE(robot.at(x_m, y_m).known()) << x_m << ", " << y_m;
    }
  }
  EXPECT_FALSE(robot.at(1.0, 0.6).known());
}

TEST(Mapper, DoesNotBelieveTheGroundMoreForStandingOnIt) {
  MappingRobot robot({}, {}, no_lasers());
  robot.roll_blindly(1.0);
  const Cell before = robot.at(1.0, 0.0);
  robot.stand(50);
  EXPECT_EQ(robot.at(1.0, 0.0), before);
}

TEST(Mapper, TakesTheGroundAroundItsStartAsLevel) {
  MappingRobot robot({}, {}, {atrv_jr_lasers()[0]});
  robot.look();
  EXPECT_TRUE(robot.at(1.0, 0.0).known());
  EXPECT_TRUE(robot.at(0.5, 1.0).known());
  EXPECT_EQ(robot.at(1.0, 0.0).height_mm, 0);
  EXPECT_FALSE(robot.at(2.5, 0.0).known());
}

TEST(Mapper, DoesNotVouchForGroundBehindAnObstacleAtItsStart) {
  MappingRobot robot({}, {}, {atrv_jr_lasers()[0]});
  robot.scene.boxes = {box(1.0, 1.2, -0.5, 0.5, 1.0)};
  robot.look();
  EXPECT_TRUE(robot.at(0.8, 0.0).known());
  EXPECT_NEAR(robot.at(1.05, 0.0).height_mm, 400, 1);
  EXPECT_FALSE(robot.at(1.5, 0.0).known());
}

TEST(Mapper, VouchesForTheGroundOnlyOnce) {
  MappingRobot robot({}, {}, {atrv_jr_lasers()[0]});
  robot.look();
  robot.forward(5.0);
  EXPECT_FALSE(robot.at(5.5, 1.0).known());
}

// ---- Submaps ------------------------------------------------------------------------------------

TEST(Mapper, BeginsItsSubmapsOnACornerOfTheSitesTiles) {
  MappingRobot robot({}, {.x_m = -3.2, .y_m = 9.7, .z_m = 12.6});
  ASSERT_NE(robot.evidence.open_submap(), nullptr);
  EXPECT_EQ(robot.evidence.open_submap()->T_site_submap, (SubmapPose{-8000, 8000, 13'000, 0}));
  EXPECT_EQ(robot.evidence.open_submap()->id, (SubmapId{kBoot, 1}));
}

TEST(Mapper, BeginsANewSubmapAfterEightMetresOfWay) {
  MappingRobot robot({}, {}, no_lasers());
  robot.roll_blindly(7.9);
  EXPECT_EQ(robot.evidence.open_submap()->id.sequence, 1U);
  robot.roll_blindly(0.2);
  EXPECT_EQ(robot.evidence.open_submap()->id.sequence, 2U);
  EXPECT_EQ(robot.evidence.open_submap()->T_site_submap.x_mm, 8000);
}

TEST(Mapper, BeginsANewSubmapAfterTwoTurnsOnTheSpot) {
  MappingRobot robot({}, {}, no_lasers());
  robot.turn(radians(700.0));
  EXPECT_EQ(robot.evidence.open_submap()->id.sequence, 1U);
  robot.turn(radians(40.0));
  EXPECT_EQ(robot.evidence.open_submap()->id.sequence, 2U);
}

TEST(Mapper, CountsTurnsBothWaysAsTurning) {
  MappingRobot robot({}, {}, no_lasers());
  for (int i = 0; i < 5; ++i) {
    robot.turn(radians(90.0));
    robot.turn(radians(-90.0));
  }
  EXPECT_EQ(robot.evidence.open_submap()->id.sequence, 2U);
}

TEST(Mapper, ClosesTheLastSubmapAtTheEnd) {
  MappingRobot robot;
  robot.forward(1.0);
  robot.mapper.finish();
  EXPECT_EQ(robot.evidence.open_submap(), nullptr);
  EXPECT_TRUE(delivered(robot.evidence, 125).at(1).closed);
}

TEST(Mapper, HoldsTrueExactlyWhatTheServerWillFoldFromItsEvidence) {
  MappingRobot robot(short_submaps(), {.x_m = -2.0, .y_m = 3.0, .z_m = 4.4, .yaw_rad = 0.4});
  robot.scene.boxes = {box(1.0, 1.5, 3.0, 6.0, 5.0), box(-1.0, 0.0, 5.0, 6.0, 4.6)};
  robot.forward(1.5);
  robot.turn(radians(200.0));
  robot.scene.boxes.pop_back();
  robot.forward(3.0);
  robot.mapper.finish();
  const HeightMap folded = fold_of(delivered(robot.evidence, 125));
  ASSERT_GT(folded.known_count(), 1000U);
  for (std::int32_t y = -200; y < 200; ++y) {
    for (std::int32_t x = -200; x < 200; ++x) {
      const Cell there = folded.cell({x, y});
      const Cell here = robot.mapper.cell({x, y});
      ASSERT_EQ(there.known(), here.known()) << x << ", " << y;
      if (!there.known()) continue;
      ASSERT_EQ(there, here) << x << ", " << y;
    }
  }
}

// ---- A world that changes -----------------------------------------------------------------------

/// Maps a box in early submaps; then the box is taken away, 2 m ahead of the robot.
struct BoxTakenAway : public ::testing::Test {
  MappingRobot robot{short_submaps()};
  Cell before;

  BoxTakenAway() {
    robot.scene.boxes = {box(4.0, 4.5, -0.5, 0.5, 0.6)};
    robot.forward(2.0);
    before = robot.at(4.05, 0.0);
    robot.scene.boxes.clear();
  }
  void look_for_long() {
    for (int i = 0; i < 20; ++i) robot.look();
  }
  std::map<std::uint32_t, Submap> submaps() {
    robot.mapper.finish();
    return delivered(robot.evidence, 125);
  }
  static constexpr CellIndex kBoxCell{32, 0};
};

TEST_F(BoxTakenAway, WasOnTheMapBefore) {
  EXPECT_NEAR(before.height_mm, 400, 60);
  EXPECT_GT(before.probability, 200);
}

TEST_F(BoxTakenAway, IsSeenThroughInALaterSubmap) {
  robot.forward(0.9);
  const auto evidence = submaps();
  const Cell seen = evidence.rbegin()->second.seen_through.cell(kBoxCell);
  ASSERT_TRUE(seen.known());
  EXPECT_LT(seen.height_mm, 350);
  EXPECT_FALSE(evidence.begin()->second.seen_through.cell(kBoxCell).known());
}

TEST_F(BoxTakenAway, IsBelievedLessOnceItWasSeenThrough) {
  robot.forward(0.9);
  const Cell after = fold_of(submaps()).cell(kBoxCell);
  EXPECT_LT(after.probability, before.probability - 50);
}

TEST_F(BoxTakenAway, IsUnlearnedWhenTwoSubmapsSawThroughIt) {
  robot.forward(0.3);
  look_for_long();
  robot.forward(0.4);
  look_for_long();
  const Cell after = fold_of(submaps()).cell(kBoxCell);
  EXPECT_TRUE(!after.known() || after.height_mm < 50) << after.height_mm;
}

TEST_F(BoxTakenAway, IsUnlearnedWhereTheRobotStands) {
  robot.forward(2.5);  // Its wheels prove that nothing stands there.
  const Cell after = fold_of(submaps()).cell(kBoxCell);
  EXPECT_NEAR(after.height_mm, 0, 10);
}

TEST(Mapper, KeepsAnObstacleThatStillStands) {
  MappingRobot robot(short_submaps());
  robot.scene.boxes = {box(6.0, 6.5, -2.0, 2.0, 1.0)};
  robot.forward(4.0);
  robot.mapper.finish();
  const auto submaps = delivered(robot.evidence, 125);
  EXPECT_GE(submaps.size(), 4U);
  const Cell wall = fold_of(submaps).cell({48, 3});
  EXPECT_GE(wall.height_mm, 390);
  EXPECT_GT(wall.probability, 200);
}

TEST(Mapper, ForgetsAPersonWhoPassed) {
  MappingRobot robot;
  std::int32_t highest_mm = 0;
  for (double y_m = -2.0; y_m <= 2.0; y_m += 0.1) {  // Across the way, 1 m/s.
    robot.scene.boxes = {box(3.0, 3.4, y_m, y_m + 0.4, 1.8)};
    robot.look();
    robot.roll_blindly(0.025);
    highest_mm = std::max(highest_mm, robot.at(3.05, 0.0).height_mm);
  }
  ASSERT_GT(highest_mm, 350);
  robot.scene.boxes.clear();
  robot.forward(3.0);
  robot.mapper.finish();
  const HeightMap site = fold_of(delivered(robot.evidence, 125));
  for (double y_m = -0.5; y_m <= 0.5; y_m += 0.125) {
    const Cell cell = site.cell(site.cell_at(3.05, y_m));
    EXPECT_TRUE(!cell.known() || cell.height_mm < 50) << y_m << ": " << cell.height_mm;
  }
}

}  // namespace
}  // namespace cairn::agent
