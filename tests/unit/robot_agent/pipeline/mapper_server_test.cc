#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "robot_agent/pipeline/mapper.h"
#include "robot_agent/pipeline/submap_frame.h"
#include "tests/unit/robot_agent/pipeline/scene.h"

/// What the server tells the map maker, and what nobody should.
namespace cairn::agent {
namespace {

using testing::box;
using testing::Scene;

/// A robot that rolls straight on past a wall, with perfect instruments.
struct MapperAndServer : public ::testing::Test {
  Scene scene{.boxes = {box(-5.0, 60.0, 3.0, 3.5, 1.0)}};
  std::vector<LaserSpec> lasers = atrv_jr_lasers();
  proto::EvidenceSender evidence;
  Mapper mapper{{}, lasers, {}, 7, evidence};
  MotionReading reading;
  double x_m = 0.0;

  MapperAndServer() { mapper.take_motion(reading); }

  void roll(double way_m) {
    for (int i = 0; i < static_cast<int>(std::lround(way_m / 0.1)); ++i) {
      reading.stamp += std::chrono::milliseconds(200);
      x_m += 0.1;
      reading.odometer_x_m += 0.1;
      mapper.take_motion(reading);
      for (std::size_t l = 0; l < lasers.size(); ++l) {
        mapper.take_scan(scene.scan(lasers[l], l, {.x_m = x_m}, reading.stamp));
      }
    }
  }
  [[nodiscard]] Cell at(double px_m, double py_m) const {
    return mapper.cell(mapper.replica().now().cell_at(px_m, py_m));
  }
};

TEST_F(MapperAndServer, MovesAlongWithTheNewestSubmapThatThePoseGraphMoved) {
  roll(20.0);
  ASSERT_GE(mapper.open_submap()->id.sequence, 3U);
  const Pose before = mapper.pose();
  const SubmapPose second = mapper.replica().find(2)->T_site_submap;
  mapper.move_submaps({{2, {second.x_mm, second.y_mm + 1000, second.z_mm, 0}}});
  EXPECT_NEAR(mapper.pose().x_m, before.x_m, 1e-3);
  EXPECT_NEAR(mapper.pose().y_m, before.y_m + 1.0, 1e-3);
  EXPECT_TRUE(at(mapper.pose().x_m, mapper.pose().y_m).known());
}

TEST_F(MapperAndServer, MovesTheMapWithoutATrace) {
  roll(20.0);
  ASSERT_GT(at(4.0, 3.05).height_mm, 300);
  const SubmapPose first = mapper.replica().find(1)->T_site_submap;
  mapper.move_submaps({{1, {first.x_mm, first.y_mm + 1000, first.z_mm, 0}}});
  EXPECT_GT(at(4.0, 4.05).height_mm, 300);
  EXPECT_FALSE(at(4.0, 3.05).known() && at(4.0, 3.05).height_mm > 300);
  EXPECT_GT(at(18.0, 4.05).height_mm, 300);  // What is newer moved along.
}

TEST_F(MapperAndServer, TurnsAboutTheMovedSubmap) {
  roll(20.0);
  const Submap& first = *mapper.replica().find(1);
  SubmapPose turned = first.T_site_submap;
  turned.yaw_1e4rad = 1000;
  const Pose T_submap_robot = from_to(pose_of(first.T_site_submap), mapper.pose());
  mapper.move_submaps({{1, turned}});
  const Pose expected = compose(pose_of(turned), T_submap_robot);
  EXPECT_NEAR(mapper.pose().x_m, expected.x_m, 1e-3);
  EXPECT_NEAR(mapper.pose().y_m, expected.y_m, 1e-3);
  EXPECT_NEAR(mapper.pose().yaw_rad, 0.1, 1e-3);
}

TEST_F(MapperAndServer, KeepsTheChainAcrossAMove) {
  roll(20.0);
  const std::uint32_t open = mapper.open_submap()->id.sequence;
  mapper.move_submaps({{1, {0, 2000, 0, 300}}});
  ASSERT_EQ(mapper.open_submap()->id.sequence, open + 1);
  const SubmapLink link = mapper.open_submap()->link.value();
  const Pose placed =
      compose(pose_of(mapper.replica().find(open)->T_site_submap), pose_of(link.T_previous_submap));
  EXPECT_NEAR(placed.x_m, mapper.open_submap()->T_site_submap.x_mm / 1e3, 5e-3);
  EXPECT_NEAR(placed.y_m, mapper.open_submap()->T_site_submap.y_mm / 1e3, 5e-3);
}

TEST_F(MapperAndServer, GoesOnWithTheOpenSubmapAfterAMoveWithinACell) {
  roll(20.0);
  const std::uint32_t open = mapper.open_submap()->id.sequence;
  mapper.move_submaps({{1, {40, -20, 0, 0}}});
  EXPECT_EQ(mapper.open_submap()->id.sequence, open);
}

TEST_F(MapperAndServer, IgnoresMovesOfSubmapsThatItDoesNotKeep) {
  roll(10.0);
  const Pose before = mapper.pose();
  mapper.move_submaps({});
  mapper.move_submaps({{99, {5000, 0, 0, 0}}});
  EXPECT_EQ(mapper.pose().x_m, before.x_m);
}

TEST_F(MapperAndServer, SeesWhatAnotherRobotMapped) {
  roll(1.0);
  HeightMap others(125);
  others.set({200, 5}, {700, 250});
  mapper.take_tiles({{{0, 3, 0}, *others.find({0, 3, 0}), 0}});
  EXPECT_EQ(mapper.cell({200, 5}).height_mm, 700);
}

TEST_F(MapperAndServer, IgnoresScansOfNoNumbers) {
  roll(1.0);
  const Pose before = mapper.pose();
  const std::size_t known = mapper.open_submap()->surface.known_count();
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -1.0F, -std::numeric_limits<float>::infinity()}) {
    mapper.take_scan({.stamp = reading.stamp, .range_m = std::vector<float>(181, bad)});
  }
  EXPECT_EQ(mapper.open_submap()->surface.known_count(), known);
  EXPECT_EQ(mapper.pose().x_m, before.x_m);
}

TEST_F(MapperAndServer, IsNotCarriedAwayByAnOdometerThatJumps) {
  roll(5.0);
  reading.odometer_x_m += 300.0;
  roll(5.0);
  EXPECT_NEAR(mapper.pose().x_m, x_m, 0.3);
  reading.odometer_x_m = std::nan("");
  mapper.take_motion(reading);
  EXPECT_TRUE(is_finite(mapper.pose()));
}

}  // namespace
}  // namespace cairn::agent
