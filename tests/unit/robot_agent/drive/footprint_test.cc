#include "robot_agent/drive/footprint.h"

#include <gtest/gtest.h>

#include "core/common/angle.h"

namespace cairn::agent {
namespace {

constexpr int kCellMm = 125;
constexpr double kCellM = 0.125;

/// A post in one cell.
LocalView view_of_post(int x_cell, int y_cell) {
  return {[x_cell, y_cell](CellIndex cell) {
            return Cell{cell.x == x_cell && cell.y == y_cell ? 1000 : 0, 200};
          },
          kCellMm,
          25,
          {0.0, 0.0},
          4.0,
          {.radius_m = 0.6}};
}

bool hits(const LocalView& view, const DriveCommand& command, const Pose& pose = {}) {
  return runs_into(view, Footprint{}, Braking{}, pose, command);
}

TEST(Footprint, GetsOverWhatIsJustAhead) {
  EXPECT_TRUE(hits(view_of_post(4, 0), {0.6, 0.0}));
  EXPECT_FALSE(hits(view_of_post(-5, 0), {0.6, 0.0}));
}

TEST(Footprint, StopsLaterWhenItIsSlower) {
  EXPECT_TRUE(hits(view_of_post(6, 0), {0.6, 0.0}));
  EXPECT_FALSE(hits(view_of_post(6, 0), {0.1, 0.0}));
}

TEST(Footprint, PassesWhatLiesBesideIt) {
  EXPECT_FALSE(hits(view_of_post(4, 3), {0.6, 0.0}));  // 0.44 m to the side.
}

TEST(Footprint, SweepsWithItsCornersWhenItTurns) {
  const LocalView beside = view_of_post(2, 3);  // 0.31 m ahead, 0.44 m to the left.
  EXPECT_TRUE(hits(beside, {0.0, 0.8}));
  EXPECT_FALSE(hits(view_of_post(4, 3), {0.0, 0.3}));  // Beyond the corner's circle.
}

TEST(Footprint, MayLeaveWhatItSeemsToStandOn) {
  const LocalView under = view_of_post(3, 0);
  EXPECT_FALSE(hits(under, {-0.3, 0.0}));
  EXPECT_FALSE(hits(under, {0.0, 0.0}));
}

TEST(Footprint, TurnsWithTheRobot) {
  const Pose sideways{0.0, 0.0, 0.0, 0.0, 0.0, radians(90)};
  EXPECT_TRUE(hits(view_of_post(0, 4), {0.6, 0.0}, sideways));
  EXPECT_FALSE(hits(view_of_post(4, 0), {0.6, 0.0}, sideways));
}

}  // namespace
}  // namespace cairn::agent
