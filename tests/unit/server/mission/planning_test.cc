#include "server/mission/planning.h"

#include <gtest/gtest.h>

namespace cairn::server {
namespace {

constexpr std::uint8_t kMinProbability = 25;

/// Adds a tile of flat floor, with a wall through its column `wall_x` when that is not negative.
void add_floor(MapSnapshot& map, const TileKey& key, int wall_x = -1) {
  Tile tile(0);
  for (int i = 0; i < Tile::kCells; ++i) {
    tile.set(i, {i % Tile::kSize == wall_x ? 1000 : 0, 200});
  }
  map.tiles[key] = std::make_shared<const PackedTile>(PackedTile::pack(tile));
}

MapSnapshot one_tile(int wall_x = -1) {
  MapSnapshot map;
  add_floor(map, {0, 0, 0}, wall_x);
  return map;
}

DrivableGrid grid_of(const MapSnapshot& map, const std::vector<Eigen::Vector2d>& points_m = {}) {
  auto grid = drivable_grid(map, points_m, PlannerConfig{}, kMinProbability);
  EXPECT_TRUE(grid) << grid.error().message;
  return std::move(grid).value();
}

bool open_at(const DrivableGrid& grid, CellIndex cell) {
  return grid.open[grid.heights.at(cell)] != 0;
}

// ---- drivable_grid ------------------------------------------------------------------------------

TEST(DrivableGridOfASnapshot, CoversExactlyItsTilesWhenThePointsLieWithin) {
  MapSnapshot map = one_tile();
  add_floor(map, {0, -2, 1});
  const HeightGrid& heights = grid_of(map, {{1.0, 10.0}}).heights;
  EXPECT_EQ(heights.origin, (CellIndex{-128, 0}));
  EXPECT_EQ(heights.width, 192);
  EXPECT_EQ(heights.height, 128);
}

TEST(DrivableGridOfASnapshot, HasTheTilesWithinThreeMetresOfAPointOutside) {
  const HeightGrid heights = grid_of(one_tile(), {{20.0, -4.9}}).heights;
  EXPECT_EQ(heights.origin, (CellIndex{0, -64}));
  EXPECT_EQ(heights.width, 192);
  EXPECT_EQ(heights.height, 128);
  EXPECT_EQ(grid_of(one_tile(), {{20.0, -5.1}}).heights.origin, (CellIndex{0, -128}));
}

TEST(DrivableGridOfASnapshot, StaysTheSameWhileARobotDrivesAlongTheEdge) {
  const CellIndex origin = grid_of(one_tile(), {{1.0, 1.0}}).heights.origin;
  EXPECT_EQ(grid_of(one_tile(), {{2.5, 2.5}}).heights.origin, origin);
}

TEST(DrivableGridOfASnapshot, TellsAnEmptyMapWithoutPointsToBeEmpty) {
  const auto grid = drivable_grid({}, {}, {}, kMinProbability);
  ASSERT_FALSE(grid);
  EXPECT_EQ(grid.error().code, ErrorCode::unavailable);
}

TEST(DrivableGridOfASnapshot, RefusesAGoalSoFarAwayThatTheWindowWouldNotFit) {
  const auto grid = drivable_grid(one_tile(), {{99'000.0, 99'000.0}}, {}, kMinProbability);
  ASSERT_FALSE(grid);
  EXPECT_EQ(grid.error().code, ErrorCode::exhausted);
}

TEST(DrivableGridOfASnapshot, IsOpenOnFloorAndClosedNearAWall) {
  const DrivableGrid grid = grid_of(one_tile(32));
  EXPECT_TRUE(open_at(grid, {10, 10}));
  EXPECT_FALSE(open_at(grid, {32, 10}));
  EXPECT_FALSE(open_at(grid, {30, 10}));  // Within the vehicle's radius.
}

TEST(DrivableGridOfASnapshot, IsClosedWhereNothingIsKnown) {
  const DrivableGrid grid = grid_of(one_tile(), {{20.0, 4.0}});
  EXPECT_FALSE(open_at(grid, {160, 32}));
}

TEST(DrivableGridOfASnapshot, DoesNotBelieveAWeakCell) {
  MapSnapshot map = one_tile();
  Tile tile = map.tiles.at({0, 0, 0})->unpack();
  tile.set(Tile::index(5, 5), {0, kMinProbability - 1});
  map.tiles[{0, 0, 0}] = std::make_shared<const PackedTile>(PackedTile::pack(tile));
  const DrivableGrid grid = grid_of(map);
  EXPECT_EQ(grid.classes[grid.heights.at({5, 5})], CellClass::unknown);
  EXPECT_EQ(grid.classes[grid.heights.at({6, 5})], CellClass::free);
}

TEST(DrivableGridOfASnapshot, ShowsTheGroundLevelOnly) {
  MapSnapshot map = one_tile();
  add_floor(map, {1, 0, 0}, 32);  // A wall on a bridge.
  EXPECT_TRUE(open_at(grid_of(map), {32, 10}));
}

// ---- rest_of ------------------------------------------------------------------------------------

TEST(RestOf, BeginsAtThePathsPointNearestToThePlace) {
  const auto rest = rest_of({{0, 0}, {4, 0}, {4, 4}}, {1.0, 0.5});
  ASSERT_EQ(rest.size(), 3U);
  EXPECT_EQ(rest[0], Eigen::Vector2d(1, 0));
  EXPECT_EQ(rest[1], Eigen::Vector2d(4, 0));
  EXPECT_EQ(rest[2], Eigen::Vector2d(4, 4));
}

TEST(RestOf, LeavesOutTheLegsThatAreDone) {
  const auto rest = rest_of({{0, 0}, {4, 0}, {4, 4}}, {4.2, 3.0});
  ASSERT_EQ(rest.size(), 2U);
  EXPECT_EQ(rest[0], Eigen::Vector2d(4, 3));
}

TEST(RestOf, IsTheWholePathBeforeItsBeginning) {
  const auto rest = rest_of({{0, 0}, {4, 0}}, {-2.0, 0.0});
  EXPECT_EQ(rest.front(), Eigen::Vector2d(0, 0));
  EXPECT_EQ(rest.back(), Eigen::Vector2d(4, 0));
}

TEST(RestOf, IsOnlyTheEndBeyondIt) {
  const auto rest = rest_of({{0, 0}, {4, 0}}, {6.0, 0.0});
  EXPECT_EQ(rest.front(), Eigen::Vector2d(4, 0));
  EXPECT_EQ(rest.back(), Eigen::Vector2d(4, 0));
}

TEST(RestOf, TakesAPathWithADoubledPoint) {
  const auto rest = rest_of({{0, 0}, {2, 0}, {2, 0}, {4, 0}}, {3.0, 0.0});
  EXPECT_EQ(rest.front(), Eigen::Vector2d(3, 0));
}

TEST(RestOf, OfAnEmptyPathIsThePlaceItself) {
  EXPECT_EQ(rest_of({}, {3, 1}), (std::vector<Eigen::Vector2d>{{3, 1}}));
}

// ---- path_is_open -------------------------------------------------------------------------------

TEST(PathIsOpen, OnOpenFloor) {
  EXPECT_TRUE(path_is_open(grid_of(one_tile()), {{1, 1}, {7, 1}, {7, 7}}));
}

TEST(PathIsOpen, NotThroughAWall) {
  EXPECT_FALSE(path_is_open(grid_of(one_tile(32)), {{1, 1}, {7, 1}}));
}

TEST(PathIsOpen, NotWhenOnlyItsLastLegIsClosed) {
  EXPECT_FALSE(path_is_open(grid_of(one_tile(32)), {{1, 1}, {1, 7}, {7, 7}}));
}

TEST(PathIsOpen, AlongsideAWall) {
  EXPECT_TRUE(path_is_open(grid_of(one_tile(32)), {{1, 1}, {3, 1}, {3, 7}}));
}

TEST(PathIsOpen, WhenItLeadsOutOfTheWallsNearness) {
  EXPECT_TRUE(path_is_open(grid_of(one_tile(32)), {{3.8, 1}, {3, 1}, {3, 7}}));
}

TEST(PathIsOpen, NotWhenItWouldLeaveItThroughTheWall) {
  EXPECT_FALSE(path_is_open(grid_of(one_tile(32)), {{3.8, 1}, {7, 1}}));
}

TEST(PathIsOpen, NotWhenItStaysInIt) {
  EXPECT_FALSE(path_is_open(grid_of(one_tile(32)), {{3.8, 1}, {3.8, 7}}));
}

TEST(PathIsOpen, NotOffTheMap) {
  EXPECT_FALSE(path_is_open(grid_of(one_tile(), {{12, 1}}), {{1, 1}, {12, 1}}));
}

}  // namespace
}  // namespace cairn::server
