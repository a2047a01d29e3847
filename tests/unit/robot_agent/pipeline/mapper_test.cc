#include "robot_agent/pipeline/mapper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/evidence_frames.h"
#include "tests/unit/robot_agent/pipeline/scene.h"

namespace cairn::agent {
namespace {

using proto::testing::delivered;
using std::chrono::milliseconds;
using testing::box;
using testing::Scene;

constexpr std::uint64_t kBoot = 77;
constexpr double kSpeed_m_s = 0.5;
constexpr Duration kPeriod = milliseconds(50);

/// The ATRV-Jr with perfect instruments in a scene.
class MappingRobot {
 public:
  explicit MappingRobot(MapperConfig config = {}, Pose start = {},
                        std::vector<LaserSpec> lasers = atrv_jr_lasers())
      : scene{.boxes = {}, .ground_m = start.z_m},
        lasers_(std::move(lasers)),
        mapper(config, lasers_, start, kBoot, evidence) {
    reading_.odometer_yaw_rad = start.yaw_rad;
    mapper.take_motion(reading_);
  }

  Scene scene;

 private:
  std::vector<LaserSpec> lasers_;
  MotionReading reading_;

 public:
  proto::EvidenceSender evidence;
  Mapper mapper;

  void look() {
    for (std::size_t i = 0; i < lasers_.size(); ++i) {
      mapper.take_scan(scene.scan(lasers_[i], i, mapper.pose(), reading_.stamp));
    }
  }
  void forward(double way_m) {
    const int steps = static_cast<int>(std::lround(way_m / (kSpeed_m_s * to_seconds(kPeriod))));
    for (int i = 0; i < steps; ++i) move(kSpeed_m_s, 0.0, i % 4 == 3);
  }
  void roll_blindly(double way_m) {
    const int steps = static_cast<int>(std::lround(way_m / (kSpeed_m_s * to_seconds(kPeriod))));
    for (int i = 0; i < steps; ++i) move(kSpeed_m_s, 0.0, false);
  }
  void stand(int readings) {
    for (int i = 0; i < readings; ++i) move(0.0, 0.0, false);
  }
  void turn(double angle_rad) {
    const double rate = angle_rad < 0.0 ? -0.5 : 0.5;
    const int steps = static_cast<int>(std::lround(angle_rad / (rate * to_seconds(kPeriod))));
    for (int i = 0; i < steps; ++i) move(0.0, rate, i % 4 == 3);
    move(0.0, 0.0, true);
  }

  /// The cell at a place.
  [[nodiscard]] Cell at(double x_m, double y_m) const {
    const double cell_m = mapper.cell_size_mm() / 1000.0;
    return mapper.cell({static_cast<std::int32_t>(std::floor(x_m / cell_m)),
                        static_cast<std::int32_t>(std::floor(y_m / cell_m))});
  }

 private:
  void move(double speed_m_s, double turn_rad_s, bool look_too) {
    const double way_m = speed_m_s * to_seconds(kPeriod);
    reading_.stamp += kPeriod;
    reading_.odometer_x_m += way_m * std::cos(reading_.odometer_yaw_rad);
    reading_.odometer_y_m += way_m * std::sin(reading_.odometer_yaw_rad);
    reading_.odometer_yaw_rad =
        wrap_angle(reading_.odometer_yaw_rad + turn_rad_s * to_seconds(kPeriod));
    reading_.gyro_yaw_rate_rad_s = turn_rad_s;
    mapper.take_motion(reading_);
    if (look_too) look();
  }
};

/// A blind robot: only its wheels know the ground.
std::vector<LaserSpec> no_lasers() { return {}; }

MapperConfig short_submaps() {
  MapperConfig config;
  config.submap_distance_m = 0.4;
  return config;
}

HeightMap fold_of(const std::map<std::uint32_t, Submap>& submaps) {
  HeightMap site(125);
  for (const auto& [sequence, submap] : submaps) (void)fold(site, submap, SensorModel{});
  return site;
}

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

// ---- Known ground -------------------------------------------------------------------------------

int known_cells(const std::map<std::uint32_t, Submap>& submaps, std::uint32_t after) {
  int cells = 0;
  for (const auto& [sequence, submap] : submaps) {
    if (sequence <= after) continue;
    for (const auto& [key, tile] : submap.surface.tiles()) cells += tile->known_count();
    for (const auto& [key, tile] : submap.seen_through.tiles()) cells += tile->known_count();
  }
  return cells;
}

/// A box and a wall that an earlier run mapped well; this one is given that map.
struct OnAGivenMap : public ::testing::Test {
  MapperConfig config = short_submaps();
  MappingRobot before{config};
  MappingRobot robot{config};
  HeightMap given{125};
  int told_before = 0;      ///< [cells]
  std::uint32_t first = 0;  ///< Submap that was open when the map came.
  static constexpr CellIndex kBoxCell{32, 0};

  OnAGivenMap() {
    before.scene.boxes = {box(4.0, 4.5, -0.5, 0.5, 0.6), box(-3.0, 8.0, 2.5, 3.0, 1.0)};
    for (int i = 0; i < 8; ++i) {
      before.forward(0.4);
      for (int look = 0; look < 10; ++look) before.look();
    }
    before.mapper.finish();
    const auto told = delivered(before.evidence, 125);
    told_before = known_cells(told, 0);
    given = fold_of(told);
    robot.scene = before.scene;
    std::vector<GivenTile> tiles;
    for (const auto& [key, tile] : given.tiles()) tiles.push_back({key, *tile, 0});
    robot.mapper.take_tiles(tiles);
    robot.forward(0.5);
    first = robot.mapper.open_submap()->id.sequence - 1;
  }
  void look_around() {
    for (int i = 0; i < 6; ++i) {
      robot.forward(0.3);
      for (int look = 0; look < 15; ++look) robot.look();
    }
    robot.mapper.finish();
  }
  /// The long-term map with all that was told since.
  HeightMap site() {
    HeightMap site = given;
    for (const auto& [sequence, submap] : delivered(robot.evidence, 125)) {
      (void)fold(site, submap, SensorModel{});
    }
    return site;
  }
};

TEST_F(OnAGivenMap, HardlyAnythingIsTold) {
  look_around();
  const int told = known_cells(delivered(robot.evidence, 125), first);
  EXPECT_LT(told, told_before / 30) << told_before;
}

TEST_F(OnAGivenMap, WhatStandsStaysOnIt) {
  look_around();
  const Cell after = site().cell(kBoxCell);
  EXPECT_GT(after.probability, 200);
  EXPECT_NEAR(after.height_mm, given.cell(kBoxCell).height_mm, 30);
}

TEST_F(OnAGivenMap, WhatWasTakenAwayIsUnlearned) {
  robot.scene.boxes.erase(robot.scene.boxes.begin());
  look_around();
  const Cell after = site().cell(kBoxCell);
  EXPECT_TRUE(!after.known() || after.height_mm < 50) << after.height_mm;
}

TEST_F(OnAGivenMap, WhatIsNewIsToldAtOnce) {
  robot.scene.boxes.push_back(box(3.0, 3.5, -1.5, -1.0, 0.6));
  for (int look = 0; look < 4; ++look) robot.look();
  bool told = false;
  for (const auto& [sequence, submap] : delivered(robot.evidence, 125)) {
    for (int x = 24; x < 28; ++x) told = told || submap.surface.cell({x, -9}).height_mm > 300;
  }
  EXPECT_TRUE(told);
}

TEST_F(OnAGivenMap, ASubmapWithoutNewsLeavesNoTrace) {
  const std::uint32_t open = robot.mapper.open_submap()->id.sequence;
  robot.roll_blindly(1.0);
  EXPECT_EQ(robot.mapper.open_submap()->id.sequence, open);
  EXPECT_EQ(robot.mapper.replica().find(open), nullptr);
}

}  // namespace
}  // namespace cairn::agent
