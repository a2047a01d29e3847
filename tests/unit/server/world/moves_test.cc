#include <gtest/gtest.h>

#include "server/world/corrections.h"
#include "server/world/placing.h"
#include "tests/unit/server/world/world_fixture.h"

/// Submaps that move after they were merged, and what robots are told of that.
namespace cairn::server {
namespace {

class MovesTest : public WorldTest {
 protected:
  Surveyor robot{7};

  void move(std::uint32_t sequence, const SubmapPose& pose) {
    const Status moved = world->move({.moves = {{{robot.boot(), sequence}, pose}}});
    ASSERT_TRUE(moved) << moved.error().message;
    world->publish();
    robot.closed.at(sequence - 1).T_site_submap = pose;
  }
  [[nodiscard]] PreparedOffer offer(std::uint64_t boot, const ToldMap& told = {}) const {
    return world->offer({.boot = boot}, told);
  }
};

TEST_F(MovesTest, TheMapIsFoldedAnewWhereASubmapLies) {
  robot.survey({0, 0}, 0);
  robot.survey({20, 20}, 100);
  deliver(robot);
  move(1, {.x_mm = 8250, .y_mm = -1000, .z_mm = 40, .yaw_1e4rad = 500});
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
  restart();
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
  EXPECT_TRUE(is_sound());
}

TEST_F(MovesTest, TilesThatNothingTouchesAnyMoreAreGone) {
  robot.survey({0, 0}, 0);
  deliver(robot);
  move(1, {.x_mm = 80'000});
  EXPECT_FALSE(cell({5, 5}).known());
  EXPECT_TRUE(cell({640 + 5, 5}).known());
  EXPECT_TRUE(is_sound());
}

TEST_F(MovesTest, AMoveThatCannotBeWrittenMovesNothing) {
  robot.survey({0, 0}, 0);
  deliver(robot);
  disk->failing.insert(disk->commits + 1);
  EXPECT_FALSE(world->move({.moves = {{{7, 1}, {.x_mm = 80'000}}}}));
  world->publish();
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
  EXPECT_TRUE(offer(7).empty());
  move(1, {.x_mm = 80'000});
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(robot.closed)));
}

TEST_F(MovesTest, WhatTheRobotPlacedBeforeItHeardOfAMoveMovesAlong) {
  robot.survey({0, 0}, 0);
  deliver(robot);
  robot.begin({.x_mm = 8000});  // Open when the first one moves,
  robot.see({3, 5}, 4, kFloor);
  deliver(robot);
  move(1, {.y_mm = 1000});
  EXPECT_EQ(cell({64 + 3, 8 + 5}), kFloor);
  robot.close();
  robot.begin({.x_mm = 16'000});  // begun before the robot heard,
  robot.see({3, 5}, 4, kFloor);
  deliver(robot);
  EXPECT_EQ(cell({128 + 3, 8 + 5}), kFloor);
  robot.close();
  robot.evidence.set_edition(1);
  robot.begin({.x_mm = 24'000});  // and after.
  robot.see({3, 5}, 4, kFloor);
  deliver(robot);
  EXPECT_EQ(cell({192 + 3, 5}), kFloor);
  restart();
  EXPECT_EQ(cell({64 + 3, 8 + 5}), kFloor);
  EXPECT_EQ(cell({192 + 3, 5}), kFloor);
}

TEST_F(MovesTest, TheRobotIsToldWhereItsSubmapsLieAndNotOfTilesItCanFoldItself) {
  robot.survey({0, 0}, 0);
  robot.survey({20, 20}, 100);
  deliver(robot);
  EXPECT_TRUE(offer(robot.boot()).empty());
  move(1, {.x_mm = 250});
  const PreparedOffer told = offer(robot.boot());
  EXPECT_TRUE(told.offer.tiles.empty());
  ASSERT_EQ(told.offer.moves.size(), 1U);
  EXPECT_EQ(told.offer.moves[0], (proto::SubmapPlace{1, {.x_mm = 250}}));
  EXPECT_EQ(told.offer.edition, 1U);
  EXPECT_TRUE(offer(robot.boot(), told.told).empty());
}

TEST_F(MovesTest, AnotherRobotIsToldOfTheTiles) {
  robot.survey({0, 0}, 0);
  deliver(robot);
  const PreparedOffer first = offer(9);
  ASSERT_EQ(first.offer.tiles.size(), 1U);
  EXPECT_EQ(first.offer.tiles[0].key, (TileKey{0, 0, 0}));
  EXPECT_EQ(first.offer.tiles[0].holds_sequence, 0U);
  EXPECT_TRUE(offer(9, first.told).empty());
  move(1, {.x_mm = 16'000});
  const PreparedOffer second = offer(9, first.told);
  ASSERT_EQ(second.offer.tiles.size(), 2U) << "one that is empty now, one that is new";
  EXPECT_EQ(second.offer.tiles[0].tile.known_count(), 0);
  EXPECT_GT(second.offer.tiles[1].tile.known_count(), 0);
}

TEST_F(MovesTest, ATileOfTwoRobotsSaysWhichOfItsOwnSubmapsItHolds) {
  Surveyor other{9};
  robot.survey({0, 0}, 0);
  other.survey({0, 0}, 20);
  deliver(robot);
  deliver(other);
  robot.begin();
  robot.see({3, 5}, 4, kFloor);
  deliver(robot);
  const PreparedOffer told = offer(robot.boot());
  ASSERT_EQ(told.offer.tiles.size(), 1U);
  EXPECT_EQ(told.offer.tiles[0].holds_sequence, 1U);
}

TEST_F(MovesTest, AfterARestartARobotHearsOfMovesAgain) {
  robot.survey({0, 0}, 0);
  deliver(robot);
  move(1, {.x_mm = 250});
  restart();
  EXPECT_EQ(offer(robot.boot()).offer.moves.size(), 1U);
  EXPECT_EQ(offer(robot.boot()).offer.edition, 1U);
}

TEST(Corrections, CarryAPoseThroughAllEditionsSinceItWasMade) {
  Corrections corrections;
  corrections.add({}, {.x_mm = 1000});
  corrections.add({.x_mm = 1000}, {.x_mm = 1000, .y_mm = 500, .yaw_1e4rad = 15'708});
  EXPECT_EQ(corrections.edition(), 2U);
  const SubmapPose old = corrections.corrected({.x_mm = 2000}, 0);  // 2 m ahead of the first.
  EXPECT_NEAR(old.x_mm, 1000, 1);
  EXPECT_NEAR(old.y_mm, 2500, 1);
  EXPECT_NEAR(old.yaw_1e4rad, 15'708, 1);
  EXPECT_EQ(corrections.corrected({.x_mm = 2000}, 2), (SubmapPose{.x_mm = 2000}));
}

TEST(Placing, StaysWithinWhatTheWireCanSay) {
  const SubmapPose far = to_submap_pose({4e6, -4e6, 1.5, 3.14159});
  EXPECT_EQ(far, (SubmapPose{proto::kMaxCoordinateMm, -proto::kMaxCoordinateMm, 1500, 31'416}));
}

TEST(Corrections, ComeBackFromTheirNote) {
  Corrections corrections;
  for (int i = 1; i <= 40; ++i) corrections.add({.x_mm = i}, {.x_mm = i, .y_mm = -i, .z_mm = 3});
  const auto back = Corrections::from_text(corrections.text());
  ASSERT_TRUE(back);
  EXPECT_EQ(back->edition(), 40U);
  EXPECT_EQ(back->text(), corrections.text());
  EXPECT_EQ(boot_of_note(corrections_note(0xF00D000000000001)), 0xF00D000000000001U);
}

TEST(Corrections, RefuseANoteThatIsNone) {
  for (const char* text : {"x", "1 2 3", "1 0 0 0 0 0 0 0 0\n1 0 0 0 0 0 0 0 0\n"}) {
    EXPECT_FALSE(Corrections::from_text(text)) << text;
  }
  EXPECT_FALSE(boot_of_note("moved/12"));
  EXPECT_FALSE(boot_of_note("next_command"));
}

}  // namespace
}  // namespace cairn::server
