#include <gtest/gtest.h>

#include "tests/unit/robot_agent/pipeline/mapping_robot.h"

/// What a robot tells of ground that it knows.
namespace cairn::agent {
namespace {

using namespace testing;  // NOLINT: the robot and its world
using proto::testing::delivered;

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
  // In the middle of a cell: on a border a millimetre of the pose would decide.
  robot.scene.boxes.push_back(box(3.06, 3.56, -1.56, -1.06, 0.6));
  for (int look = 0; look < 4; ++look) robot.look();
  bool told = false;
  for (const auto& [sequence, submap] : delivered(robot.evidence, 125)) {
    for (int x = 24; x < 28; ++x) told = told || submap.surface.cell({x, -10}).height_mm > 300;
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
