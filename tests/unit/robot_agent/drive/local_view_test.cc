#include "robot_agent/drive/local_view.h"

#include <gtest/gtest.h>

namespace cairn::agent {
namespace {

constexpr int kCellMm = 100;
constexpr std::uint8_t kMinProbability = 25;
constexpr double kReachM = 4.0;
const VehicleLimits kSlim{.radius_m = 0.0};

Cell floor_everywhere(CellIndex) { return {0, 200}; }

/// Floor with a wall of 1 m from x_cell on.
CellLookup wall_from(int x_cell) {
  return [x_cell](CellIndex cell) { return Cell{cell.x >= x_cell ? 1000 : 0, 200}; };
}

LocalView view_of(const CellLookup& cells, const VehicleLimits& limits = kSlim) {
  return {cells, kCellMm, kMinProbability, {0.05, 0.05}, kReachM, limits};
}

/// What lies on the way straight east.
Ahead east(const LocalView& view, double distance_m = 3.0) {
  return view.look_along({{0.05, 0.05}, {3.55, 0.05}}, distance_m);
}

TEST(LocalView, FindsOpenGroundClearAsFarAsItLooks) {
  const Ahead ahead = east(view_of(floor_everywhere));
  EXPECT_EQ(ahead.clear_m, 3.0);
  EXPECT_FALSE(ahead.gap);
  EXPECT_EQ(ahead.known_m, 3.0);
}

TEST(LocalView, SeesAWallAtItsDistance) {
  EXPECT_NEAR(east(view_of(wall_from(20))).clear_m, 1.95, 0.06);
}

TEST(LocalView, KeepsTheVehiclesRadiusFromAWall) {
  EXPECT_NEAR(east(view_of(wall_from(20), {.radius_m = 0.5})).clear_m, 1.55, 0.06);
}

TEST(LocalView, DoesNotSeeAWallBeyondTheDistance) {
  EXPECT_EQ(east(view_of(wall_from(20)), 1.5).clear_m, 1.5);
}

TEST(LocalView, SeesTheEdgeOfADrop) {
  const auto cliff = [](CellIndex cell) { return Cell{cell.x >= 20 ? -1000 : 0, 200}; };
  EXPECT_NEAR(east(view_of(cliff)).clear_m, 1.85, 0.06);  // The top's last cell is closed.
}

TEST(LocalView, PassesAStepThatTheVehicleClimbs) {
  const auto kerb = [](CellIndex cell) { return Cell{cell.x >= 20 ? 80 : 0, 200}; };
  EXPECT_EQ(east(view_of(kerb)).clear_m, 3.0);
}

TEST(LocalView, FollowsThePathRoundACorner) {
  const LocalView view = view_of(wall_from(20));
  EXPECT_EQ(view.look_along({{0.05, 0.05}, {1.0, 0.05}, {1.0, 3.0}}, 3.0).clear_m, 3.0);
}

TEST(LocalView, MeasuresTheDistanceAlongABentPath) {
  const LocalView view = view_of(wall_from(20));
  const Ahead ahead = view.look_along({{0.05, 0.05}, {0.05, 1.05}, {3.05, 1.05}}, 3.5);
  EXPECT_NEAR(ahead.clear_m, 1.0 + 1.95, 0.06);
}

/// Floor that nobody has seen from one column up to another, and is `rise_mm` higher behind it.
CellLookup unseen_between(int from, int to, std::int32_t rise_mm = 0) {
  return [=](CellIndex cell) {
    if (cell.x >= from && cell.x < to) return Cell{};
    return Cell{cell.x < to ? 0 : rise_mm, 200};
  };
}

TEST(LocalView, MeasuresAStretchOfUnseenGround) {
  const Ahead ahead = east(view_of(unseen_between(10, 17)));
  EXPECT_EQ(ahead.clear_m, 3.0);
  EXPECT_NEAR(ahead.known_m, 0.95, 0.06);
  ASSERT_TRUE(ahead.gap);
  EXPECT_NEAR(ahead.gap->from_m, 0.95, 0.06);
  EXPECT_NEAR(ahead.gap->length_m, 0.7, 0.06);
}

TEST(LocalView, TellsHowMuchTheGroundRisesAcrossAnUnseenStretch) {
  const Ahead ahead = east(view_of(unseen_between(10, 17, -90)));
  ASSERT_TRUE(ahead.gap);
  EXPECT_NEAR(ahead.gap->rise_m, 0.09, 1e-9);
}

TEST(LocalView, DoesNotKnowTheRiseWhereTheFarSideIsUnseen) {
  const Ahead ahead = east(view_of(unseen_between(10, 1000)));
  ASSERT_TRUE(ahead.gap);
  EXPECT_EQ(ahead.gap->rise_m, std::numeric_limits<double>::infinity());
}

TEST(LocalView, TakesAShortUnseenStretchForAGapBetweenBeams) {
  const Ahead ahead = east(view_of(unseen_between(10, 15)));
  EXPECT_FALSE(ahead.gap);
  EXPECT_NEAR(ahead.known_m, 0.95, 0.06);
}

TEST(LocalView, DoesNotBelieveAWeakCell) {
  const auto weak = [](CellIndex cell) {
    return Cell{0, cell.x >= 10 ? std::uint8_t{24} : std::uint8_t{200}};
  };
  EXPECT_NEAR(east(view_of(weak)).known_m, 0.95, 0.06);
}

TEST(LocalView, LetsTheVehicleLeaveAClosedCell) {
  // A wall behind the vehicle, nearer than its radius: its own cell is closed.
  const auto wall_behind = [](CellIndex cell) { return Cell{cell.x <= -3 ? 1000 : 0, 200}; };
  EXPECT_EQ(east(view_of(wall_behind, {.radius_m = 0.5})).clear_m, 3.0);
}

TEST(LocalView, DoesNotLetItDriveIntoWhatClosesItsCell) {
  const Ahead ahead = east(view_of(wall_from(3), {.radius_m = 0.5}));
  EXPECT_LE(ahead.clear_m, 0.5 + 0.06);
}

TEST(LocalView, WorksWithHeightsFarFromZero) {
  const auto high = [](CellIndex cell) { return Cell{cell.x >= 20 ? 801'000 : 800'000, 200}; };
  EXPECT_NEAR(east(view_of(high)).clear_m, 1.95, 0.06);
}

TEST(LocalView, WorksOnTheNegativeSideOfTheSite) {
  const auto wall = [](CellIndex cell) { return Cell{cell.x >= -180 ? 1000 : 0, 200}; };
  const LocalView view(wall, kCellMm, kMinProbability, {-19.95, -7.95}, kReachM, kSlim);
  const Ahead ahead = view.look_along({{-19.95, -7.95}, {-16.5, -7.95}}, 3.0);
  EXPECT_NEAR(ahead.clear_m, 1.95, 0.06);
}

}  // namespace
}  // namespace cairn::agent
