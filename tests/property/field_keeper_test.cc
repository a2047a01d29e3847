#include "core/planner/field_keeper.h"

#include <gtest/gtest.h>

#include <random>

#include "core/planner/plan.h"
#include "tests/support/plain_field.h"

namespace cairn {
namespace {

int below(std::mt19937& random, int limit) {
  return static_cast<int>(random() % static_cast<unsigned>(limit));
}

std::int32_t random_height(std::mt19937& random) {
  return below(random, 5) == 0 ? 1000 : below(random, 120);
}

HeightGrid random_grid(std::mt19937& random, int most) {
  const CellIndex low{below(random, 100) - 50, below(random, 100) - 50};
  const CellIndex high{low.x + below(random, most), low.y + below(random, most)};
  HeightGrid grid = empty_grid(low, high, 125).value();
  const bool flat = below(random, 3) == 0;
  // Often nobody has seen the east: how high it may lie is told from the last cells before it.
  const int seen = below(random, 3) == 0 ? below(random, grid.width) : grid.width;
  for (std::size_t i = 0; i < grid.height_mm.size(); ++i) {
    const bool unseen = static_cast<int>(i) % grid.width >= seen;
    grid.probability[i] = unseen || below(random, 15) == 0 ? 0 : 200;
    grid.height_mm[i] = flat ? 0 : random_height(random);
  }
  return grid;
}

PlannerConfig random_config(std::mt19937& random) {
  PlannerConfig config;
  config.limits.climb_mm = 80 + below(random, 100);
  config.limits.descend_mm =
      below(random, 2) == 0 ? config.limits.climb_mm : 60 + below(random, 200);
  config.limits.radius_m = below(random, 2) == 0 ? 0.01 * below(random, 30) : 0.0;
  config.unknown = below(random, 3) == 0 ? UnknownGround::allowed : UnknownGround::blocked;
  config.climb_effort = below(random, 20);
  config.descend_effort = below(random, 10);
  if (below(random, 3) == 0) {
    config.obstacle_price = below(random, 6);
    config.roughness_price = below(random, 4);
    config.slope_price = below(random, 3);
    config.closeness_price = below(random, 2) == 0 ? 2.5 : 0.0;
    config.closeness_m = 0.1 + 0.1 * below(random, 6);
  }
  return config;
}

/// Something put down, taken away, raised, forgotten or seen for the first time, in one place or
/// all over the map.
std::vector<CellChange> random_changes(const HeightGrid& grid, std::mt19937& random) {
  std::vector<CellChange> changes;
  const CellIndex low{grid.origin.x + below(random, grid.width),
                      grid.origin.y + below(random, grid.height)};
  const int kind = below(random, 4);
  const int size = 1 + below(random, 5);
  for (int i = 0; i < size * size; ++i) {
    CellIndex cell{low.x + i % size, low.y + i / size};
    if (kind == 3)
      cell = {grid.origin.x + below(random, grid.width + 2) - 1,
              grid.origin.y + below(random, grid.height)};
    const std::int32_t height = kind == 0 ? 1000 : kind == 1 ? 0 : random_height(random);
    changes.push_back({cell, height, static_cast<std::uint8_t>(below(random, 10) == 0 ? 0 : 200)});
  }
  return changes;
}

/// Whether the keeper has what a new plan on its heights would have.
void expect_like_new(const FieldKeeper& keeper, const PlannerConfig& config) {
  const DrivableGrid grid = make_drivable(keeper.grid().heights, config);
  ASSERT_EQ(keeper.grid().classes, grid.classes);
  ASSERT_EQ(keeper.grid().open, grid.open);
  const auto field = compute_field(grid, keeper.field().goal);
  const auto costs = test::costs(keeper.grid(), keeper.field());
  if (field) {
    ASSERT_EQ(costs, test::costs(grid, *field));
    ASSERT_EQ(keeper.field().levelled, field->levelled);
  } else {
    ASSERT_EQ(costs, std::vector<std::uint32_t>(costs.size(), kNoWay));
  }
}

void expect_same_path(const FieldKeeper& keeper, const PlannerConfig& config,
                      std::mt19937& random) {
  const HeightGrid& heights = keeper.grid().heights;
  const CellIndex start{heights.origin.x + below(random, heights.width),
                        heights.origin.y + below(random, heights.height)};
  const auto middle_m = [](CellIndex cell) {
    return Eigen::Vector2d((cell.x + 0.5) * 0.125, (cell.y + 0.5) * 0.125);
  };
  const PlanRequest request{middle_m(start), middle_m(keeper.field().goal), below(random, 2) == 0,
                            0.06};
  const Path kept = plan(keeper.grid(), keeper.field(), request, config);
  const Path anew = plan(make_drivable(heights, config), request, config);
  ASSERT_EQ(kept.status, anew.status);
  ASSERT_EQ(kept.why, anew.why);
  ASSERT_EQ(kept.points_m, anew.points_m);
  ASSERT_EQ(kept.cost_m, anew.cost_m);
}

void follow_changes(unsigned first_seed, unsigned last_seed, int most, int steps) {
  int kept = 0;
  for (unsigned seed = first_seed; seed < last_seed; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const PlannerConfig config = random_config(random);
    HeightGrid heights = random_grid(random, most);
    const CellIndex goal{heights.origin.x + below(random, heights.width),
                         heights.origin.y + below(random, heights.height)};
    auto keeper = FieldKeeper::create(make_drivable(std::move(heights), config), config, goal);
    if (!keeper) continue;
    ++kept;
    for (int step = 0; step < steps; ++step) {
      SCOPED_TRACE("step " + std::to_string(step));
      keeper->change(random_changes(keeper->grid().heights, random));
      expect_like_new(*keeper, config);
      if (!testing::Test::HasFatalFailure()) expect_same_path(*keeper, config, random);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  EXPECT_GT(kept, static_cast<int>(last_seed - first_seed) / 3);
}

TEST(FieldKeeperProperty, AfterAnyChangesEqualsANewPlan) { follow_changes(0, 700, 30, 8); }

TEST(FieldKeeperProperty, AfterAnyChangesEqualsANewPlanOverManyTiles) {
  follow_changes(5000, 5012, 200, 6);
}

}  // namespace
}  // namespace cairn
