#include "server/mission/kept_fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <thread>

namespace cairn::server {
namespace {

constexpr std::uint8_t kMinProbability = 25;

using Random = std::mt19937;

int below(Random& random, int limit) {
  return static_cast<int>(random() % static_cast<unsigned>(limit));
}

void put(MapSnapshot& map, const TileKey& key, const Tile& tile) {
  map.tiles[key] = std::make_shared<const PackedTile>(PackedTile::pack(tile));
}

std::int32_t rolling_mm(int i) {
  const int x = i % Tile::kSize;
  const int y = i / Tile::kSize;
  return static_cast<std::int32_t>(80.0 * std::sin(0.1 * x) + 60.0 * std::cos(0.1 * y));
}

/// With a place that nobody has seen and one that is not to be believed.
Tile rolling_ground(Random& random) {
  Tile tile(0);
  const int unseen = below(random, Tile::kCells);
  for (int i = 0; i < Tile::kCells; ++i) {
    const int x = i % Tile::kSize - unseen % Tile::kSize;
    const int y = i / Tile::kSize - unseen / Tile::kSize;
    if (x * x + y * y < 20) continue;
    const bool weak = x >= 6 && x < 9 && y >= 0 && y < 3;
    tile.set(i, {rolling_mm(i), static_cast<std::uint8_t>(weak ? 20 : 100)});
  }
  return tile;
}

/// `size` × `size` tiles.
MapSnapshot rolling_map(int size, Random& random) {
  MapSnapshot map;
  for (int i = 0; i < size * size; ++i) put(map, {0, i % size, i / size}, rolling_ground(random));
  return map;
}

/// A block put down, ground forgotten or seen anew, or a whole tile gone, in some place.
void change(MapSnapshot& map, Random& random) {
  ++map.version;
  auto at = std::next(map.tiles.begin(), below(random, static_cast<int>(map.tiles.size())));
  if (below(random, 8) == 0 && map.tiles.size() > 2) {
    map.tiles.erase(at);
    return;
  }
  Tile tile = at->second->unpack();
  const int kind = below(random, 3);
  const int left = below(random, 56);
  const int bottom = below(random, 56);
  for (int i = 0; i < 64; ++i) {
    const int index = Tile::index(left + i % 8, bottom + i / 8);
    const std::int32_t raised_mm = rolling_mm(index) + 30;
    tile.set(index, {kind == 0 ? 900 : raised_mm, static_cast<std::uint8_t>(kind == 1 ? 5 : 200)});
  }
  put(map, at->first, tile);
}

PlanTarget target(const MapSnapshot& map, Eigen::Vector2d start_m, Eigen::Vector2d goal_m,
                  UnknownGround unknown = UnknownGround::allowed) {
  PlanTarget target{"yard", std::make_shared<const MapSnapshot>(map), {start_m, goal_m}, {}};
  target.request.allow_partial = true;
  target.planner.unknown = unknown;
  target.planner.limits.radius_m = 0.2;
  return target;
}

Path planned(KeptFields& fields, const PlanTarget& target) {
  Path path;
  EXPECT_TRUE(fields.with(target, [&](const KeptField& field) { path = field.plan(target); }));
  return path;
}

Path planned_anew(const PlanTarget& target) {
  const auto grid = drivable_grid(*target.map, {target.request.start_m, target.request.goal_m},
                                  target.planner, kMinProbability);
  return plan(grid.value(), target.request, target.planner);
}

void expect_like_new(KeptFields& fields, const PlanTarget& target) {
  const Path kept = planned(fields, target);
  const Path anew = planned_anew(target);
  ASSERT_EQ(kept.status, anew.status);
  ASSERT_EQ(kept.why, anew.why);
  ASSERT_EQ(kept.points_m, anew.points_m);
  ASSERT_EQ(kept.cost_m, anew.cost_m);
}

TEST(KeptFields, PlanAsANewPlanWouldWhateverChanges) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    KeptFields fields(kMinProbability);
    MapSnapshot map = rolling_map(3, random);
    const auto place_m = [&] {
      return Eigen::Vector2d(0.1 * below(random, 235), 0.1 * below(random, 235));
    };
    const Eigen::Vector2d goals_m[] = {place_m(), place_m()};
    const UnknownGround unknown = seed % 2 == 0 ? UnknownGround::allowed : UnknownGround::blocked;
    for (int step = 0; step < 8; ++step) {
      SCOPED_TRACE("step " + std::to_string(step));
      expect_like_new(fields, target(map, place_m(), goals_m[step % 2], unknown));
      if (testing::Test::HasFatalFailure()) return;
      for (int i = below(random, 4); i >= 0; --i) change(map, random);
    }
  }
}

TEST(KeptFields, PlanAnewWhenTheMapHasGrown) {
  Random random(1);
  KeptFields fields(kMinProbability);
  MapSnapshot map = rolling_map(2, random);
  expect_like_new(fields, target(map, {4, 4}, {12, 12}));
  put(map, {0, 5, -3}, rolling_ground(random));
  expect_like_new(fields, target(map, {4, 4}, {12, 12}));
  expect_like_new(fields, target(map, {43, -20}, {12, 12}));
  EXPECT_EQ(fields.count(), 1U);
}

TEST(KeptFields, FollowAGoalThatIsClosedAndOpensAgain) {
  Random random(2);
  KeptFields fields(kMinProbability);
  const MapSnapshot open = rolling_map(2, random);
  MapSnapshot closed = open;
  Tile tile = closed.tiles.at({0, 1, 1})->unpack();
  for (int i = 0; i < 64; ++i) tile.set(Tile::index(28 + i % 8, 28 + i / 8), {900, 200});
  put(closed, {0, 1, 1}, tile);
  expect_like_new(fields, target(open, {4, 4}, {12, 12}));
  expect_like_new(fields, target(closed, {4, 4}, {12, 12}));
  expect_like_new(fields, target(open, {4, 4}, {12, 12}));
}

TEST(KeptFields, KeepNothingOfAGoalThatIsClosed) {
  Random random(3);
  MapSnapshot map = rolling_map(2, random);
  KeptFields fields(kMinProbability);
  expect_like_new(fields, target(map, {4, 4}, {30, 30}, UnknownGround::blocked));
  EXPECT_EQ(fields.count(), 0U);
  EXPECT_EQ(fields.memory_bytes(), 0U);
}

TEST(KeptFields, TellAnEmptyMapToBeEmpty) {
  KeptFields fields(kMinProbability);
  const auto far = target({}, {0, 0}, {90'000, 90'000});
  const Status status = fields.with(far, [](const KeptField&) { FAIL(); });
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::exhausted);
  EXPECT_EQ(fields.count(), 0U);
}

TEST(KeptFields, TellSitesVehiclesAndGoalsApart) {
  Random random(4);
  KeptFields fields(kMinProbability);
  const MapSnapshot map = rolling_map(2, random);
  PlanTarget one = target(map, {4, 4}, {12, 12});
  expect_like_new(fields, one);
  one.site = "hall";
  expect_like_new(fields, one);
  one.planner.limits.radius_m = 0.3;
  expect_like_new(fields, one);
  one.request.goal_m = {12.2, 12.2};
  expect_like_new(fields, one);
  EXPECT_EQ(fields.count(), 4U);
}

TEST(KeptFields, StayWithinTheirBytes) {
  Random random(5);
  const MapSnapshot map = rolling_map(2, random);
  KeptFields unbounded(kMinProbability);
  (void)planned(unbounded, target(map, {4, 4}, {12, 12}));
  const std::size_t one_field = unbounded.memory_bytes();
  EXPECT_GT(one_field, 2U * 2U * 4096U * 15U);
  KeptFields fields(kMinProbability, 3 * one_field + one_field / 2);
  for (int i = 0; i < 10; ++i) {
    expect_like_new(fields, target(map, {4, 4}, {3.0 + i, 12}));
    EXPECT_LE(fields.memory_bytes(), 3 * one_field + one_field / 2);
  }
  EXPECT_EQ(fields.count(), 3U);
  KeptFields none(kMinProbability, one_field / 2);
  expect_like_new(none, target(map, {4, 4}, {12, 12}));
  EXPECT_EQ(none.count(), 0U);
}

TEST(KeptFields, StayWithinTheirNumber) {
  Random random(6);
  const MapSnapshot map = rolling_map(1, random);
  KeptFields fields(kMinProbability);
  for (int i = 0; i < 100; ++i) {
    (void)planned(fields, target(map, {4, 4}, {1.0 + 0.13 * (i % 10), 1.0 + 0.13 * (i / 10)}));
  }
  EXPECT_EQ(fields.count(), KeptFields::kMostFields);
}

TEST(KeptFields, ForgetWhatWasNotUsedForLongest) {
  Random random(7);
  const MapSnapshot map = rolling_map(1, random);
  KeptFields fields(kMinProbability);
  const PlanTarget robots = target(map, {4, 4}, {7, 7});
  (void)planned(fields, robots);
  const std::size_t one_field = fields.memory_bytes();
  KeptFields two(kMinProbability, 2 * one_field);
  const auto grid_of = [&](const PlanTarget& wanted) {
    const DrivableGrid* grid = nullptr;
    EXPECT_TRUE(two.with(wanted, [&](const KeptField& field) { grid = &field.grid(); }));
    return grid;
  };
  const DrivableGrid* kept = grid_of(robots);
  for (int i = 0; i < 5; ++i) {
    (void)grid_of(target(map, {4, 4}, {1.0 + i, 2}));
    EXPECT_EQ(grid_of(robots), kept);
  }
}

TEST(KeptFields, MayBeAskedByManyThreads) {
  Random random(8);
  const MapSnapshot map = rolling_map(2, random);
  MapSnapshot later = map;
  for (int i = 0; i < 5; ++i) change(later, random);
  KeptFields fields(kMinProbability);
  std::vector<PlanTarget> targets;
  std::vector<Path> expected;
  for (int i = 0; i < 6; ++i) {
    targets.push_back(target(i % 2 == 0 ? map : later, {4, 4}, {10.0 + i / 4, 12}));
    expected.push_back(planned_anew(targets.back()));
  }
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    threads.emplace_back([&, i] {
      for (int round = 0; round < 5; ++round) {
        EXPECT_EQ(planned(fields, targets[i]).points_m, expected[i].points_m);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(fields.count(), 2U);
}

}  // namespace
}  // namespace cairn::server
