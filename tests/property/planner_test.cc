#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/planner/field_walk.h"
#include "core/planner/plan.h"
#include "core/planner/tile_wave.h"
#include "core/planner/wave.h"
#include "tests/support/plain_field.h"

namespace cairn {
namespace {

int below(std::mt19937& random, int limit) {
  return static_cast<int>(random() % static_cast<unsigned>(limit));
}

/// Hills, one-way ledges, blocks and unknown patches, away from the origin.
HeightGrid random_grid(std::mt19937& random, int relief_mm) {
  const CellIndex low{below(random, 100) - 50, below(random, 100) - 50};
  HeightGrid grid =
      empty_grid(low, {low.x + below(random, 40), low.y + below(random, 40)}, 125).value();
  const int blocks = 3 + below(random, 30);
  for (std::size_t i = 0; i < grid.height_mm.size(); ++i) {
    grid.probability[i] = below(random, 12) == 0 ? 0 : 200;
    grid.height_mm[i] = below(random, relief_mm + 1);
    if (below(random, blocks) == 0) grid.height_mm[i] += 1000;
  }
  return grid;
}

PlannerConfig random_config(std::mt19937& random) {
  PlannerConfig config;
  config.limits.climb_mm = below(random, 300);
  config.limits.descend_mm = below(random, 300);
  config.limits.radius_m = below(random, 3) == 0 ? 0.01 * below(random, 40) : 0.0;
  config.unknown = below(random, 2) == 0 ? UnknownGround::allowed : UnknownGround::blocked;
  config.unknown_price = 1 + 0.01 * below(random, 500);
  config.climb_effort = 0.1 * below(random, 200);
  config.descend_effort = 0.1 * below(random, 100);
  if (below(random, 3) == 0) config.roughness_price = config.obstacle_price = below(random, 20);
  return config;
}

CellIndex cell_of(const HeightGrid& grid, std::size_t at) {
  const auto width = static_cast<std::size_t>(grid.width);
  return {grid.origin.x + static_cast<std::int32_t>(at % width),
          grid.origin.y + static_cast<std::int32_t>(at / width)};
}

CellIndex random_cell(const HeightGrid& grid, std::mt19937& random) {
  return {grid.origin.x + below(random, grid.width), grid.origin.y + below(random, grid.height)};
}

struct Problem {
  explicit Problem(unsigned seed, int relief_mm = 150)
      : random(seed),
        config(random_config(random)),
        grid(make_drivable(random_grid(random, relief_mm), config)),
        goal(random_cell(grid.heights, random)) {
    grid.open[grid.heights.at(goal)] = 1;
    price_ground(grid, config, {0, 0, grid.heights.width - 1, grid.heights.height - 1});
  }

  std::mt19937 random;
  PlannerConfig config;
  DrivableGrid grid;
  CellIndex goal;
};

TEST(PlannerProperty, FieldIsTheOnlyOneThatKeepsItsOwnRule) {
  for (unsigned seed = 0; seed < 1500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Problem p(seed);
    const Field field = compute_field(p.grid, p.goal).value();
    ASSERT_EQ(test::costs(p.grid, field), test::plain_field(p.grid, p.goal));
  }
}

/// As large as several tiles.
HeightGrid wide_grid(std::mt19937& random, int relief_mm) {
  HeightGrid grid =
      empty_grid({-20, 7}, {40 + below(random, 200), 50 + below(random, 150)}, 125).value();
  const int blocks = 3 + below(random, 40);
  const int unknown = below(random, 2) == 0 ? 1 << 30 : 20;
  for (std::size_t i = 0; i < grid.height_mm.size(); ++i) {
    grid.probability[i] = below(random, unknown) == 1 ? 0 : 200;
    grid.height_mm[i] = below(random, relief_mm + 1) + (below(random, blocks) == 0 ? 1000 : 0);
  }
  return grid;
}

TEST(PlannerProperty, EveryWayOfSolvingGivesTheSameField) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    PlannerConfig config = random_config(random);
    if (seed % 2 == 0) config.limits.climb_mm = config.limits.descend_mm = 120;
    DrivableGrid grid = make_drivable(wide_grid(random, seed % 3 == 0 ? 0 : 100), config);
    const CellIndex goal = random_cell(grid.heights, random);
    grid.open[grid.heights.at(goal)] = 1;
    price_ground(grid, config, {0, 0, grid.heights.width - 1, grid.heights.height - 1});
    Field by_cells = unreached_field(grid, goal);
    Wave(grid, by_cells).radiate();
    for (const FieldKernels* kernels : usable_field_kernels()) {
      Field by_tiles = unreached_field(grid, goal);
      TileWave(grid, by_tiles, *kernels).radiate();
      ASSERT_EQ(by_tiles.levelled, by_cells.levelled) << kernels->name;
    }
  }
}

TEST(PlannerProperty, FieldIsNeverDearerThanStepsFromCellToCell) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Problem p(seed);
    const Field field = compute_field(p.grid, p.goal).value();
    const auto costs = test::costs(p.grid, field);
    const auto in_steps = test::plain_dijkstra(p.grid, p.goal);
    for (std::size_t i = 0; i < costs.size(); ++i) {
      ASSERT_EQ(costs[i] == kNoWay, in_steps[i] == kNoWay);
      ASSERT_LE(costs[i], in_steps[i]);
      ASSERT_GE(costs[i] * 1.09 + 1, costs[i] == kNoWay ? 0 : in_steps[i]);
    }
  }
}

TEST(PlannerProperty, CellsDownLeadToTheGoalInDrivableStepsWithFallingCost) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Problem p(seed);
    const Field field = compute_field(p.grid, p.goal).value();
    for (const CellIndex start : test::cells_of(p.grid.heights)) {
      if (cost_to_goal(p.grid, field, start) == kNoWay) continue;
      const std::vector<CellIndex> cells = cells_down(p.grid, field, start);
      ASSERT_EQ(cells.back(), p.goal);
      for (std::size_t i = 1; i < cells.size(); ++i) {
        ASSERT_LT(cost_to_goal(p.grid, field, cells[i]), cost_to_goal(p.grid, field, cells[i - 1]));
        bool is_step = false;
        for (int d = 0; d < 8; ++d) {
          const CellIndex next{cells[i - 1].x + kStepX[d], cells[i - 1].y + kStepY[d]};
          is_step = is_step || (next == cells[i] && step_cost(p.grid, cells[i - 1], d) != kNoWay);
        }
        ASSERT_TRUE(is_step);
      }
    }
  }
}

/// Cells that can be walked to from `start` over open cells, cutting no corner.
std::vector<bool> flood(const DrivableGrid& grid, CellIndex start) {
  const auto open = [&](int x, int y) {
    return grid.heights.contains({x, y}) && grid.open[grid.heights.at({x, y})] != 0;
  };
  std::vector<bool> reached(grid.open.size());
  std::vector<CellIndex> waiting{start};
  reached[grid.heights.at(start)] = true;
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    const CellIndex c = waiting[i];
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const bool free_way =
            open(c.x + dx, c.y + dy) && open(c.x + dx, c.y) && open(c.x, c.y + dy);
        if (!free_way || reached[grid.heights.at({c.x + dx, c.y + dy})]) continue;
        reached[grid.heights.at({c.x + dx, c.y + dy})] = true;
        waiting.push_back({c.x + dx, c.y + dy});
      }
    }
  }
  return reached;
}

TEST(PlannerProperty, OnFlatMapsReachesWhatABreadthFirstSearchReaches) {
  for (unsigned seed = 0; seed < 1000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Problem p(seed, 0);
    const Field field = compute_field(p.grid, p.goal).value();
    const std::vector<bool> reached = flood(p.grid, p.goal);
    // The goal's own ground may be a block: then steps onto it are what the limits are about.
    if (p.grid.classes[p.grid.heights.at(p.goal)] == CellClass::obstacle) continue;
    const auto costs = test::costs(p.grid, field);
    for (std::size_t i = 0; i < costs.size(); ++i) {
      ASSERT_EQ(costs[i] != kNoWay, reached[i]) << "cell " << i;
    }
  }
}

TEST(PlannerProperty, ClearanceIsThatOfEveryPairOfCells) {
  for (unsigned seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    PlannerConfig config;
    config.unknown = UnknownGround::allowed;
    config.limits.radius_m = 0.005 * below(random, 300);
    const DrivableGrid grid = make_drivable(random_grid(random, 0), config);
    for (std::size_t i = 0; i < grid.open.size(); ++i) {
      const CellIndex a = cell_of(grid.heights, i);
      bool open = grid.classes[i] != CellClass::obstacle;
      for (std::size_t j = 0; j < grid.open.size(); ++j) {
        if (grid.classes[j] != CellClass::obstacle) continue;
        const CellIndex b = cell_of(grid.heights, j);
        const std::int64_t x_mm = (a.x - b.x) * 125;
        const std::int64_t y_mm = (a.y - b.y) * 125;
        const std::int64_t radius_mm = std::llround(config.limits.radius_m * 1000);
        open = open && x_mm * x_mm + y_mm * y_mm >= radius_mm * radius_mm;
      }
      ASSERT_EQ(grid.open[i] != 0, open) << "cell " << i;
    }
  }
}

/// A point anywhere in a cell, sometimes on its border.
Eigen::Vector2d point_in(CellIndex cell, std::mt19937& random) {
  return {0.125 * cell.x + 0.0125 * below(random, 10), 0.125 * cell.y + 0.0125 * below(random, 10)};
}

/// Walks the polyline in small steps.
template <class Visit>
void walk(const std::vector<Eigen::Vector2d>& points_m, Visit&& visit) {
  for (std::size_t i = 1; i < points_m.size(); ++i) {
    for (int k = 0; k <= 200; ++k) {
      visit(points_m[i - 1] + (points_m[i] - points_m[i - 1]) * (k / 200.0));
    }
  }
}

TEST(PlannerProperty, PathsFromOpenCellsStayOpenAndKeepTheFieldsCost) {
  int complete = 0;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Problem p(seed);
    const CellIndex start = random_cell(p.grid.heights, p.random);
    if (!p.grid.open[p.grid.heights.at(start)]) continue;
    PlanRequest request{point_in(start, p.random), point_in(p.goal, p.random)};
    request.tolerance_m = 0.05 * below(p.random, 10);
    const Path path = plan(p.grid, request, p.config);
    const std::uint32_t cost = test::plain_field(p.grid, p.goal)[p.grid.heights.at(start)];
    ASSERT_EQ(path.status, cost == kNoWay ? PathStatus::none : PathStatus::complete);
    if (path.status == PathStatus::none) continue;
    ++complete;
    ASSERT_NEAR(path.cost_m, cost * p.grid.unit_m(), 1e-9);
    ASSERT_EQ(path.points_m.front(), request.start_m);
    ASSERT_EQ(path.points_m.back(), request.goal_m);
    walk(path.points_m, [&](const Eigen::Vector2d& point) {
      // On a border the point belongs to both cells: one of them is open.
      const auto open_at = [&](double off) {
        const CellIndex cell{static_cast<int>(std::floor(point.x() / 0.125 + off)),
                             static_cast<int>(std::floor(point.y() / 0.125 + off))};
        return p.grid.heights.contains(cell) && p.grid.open[p.grid.heights.at(cell)] != 0;
      };
      ASSERT_TRUE(open_at(1e-6) || open_at(-1e-6)) << point.transpose();
    });
  }
  EXPECT_GT(complete, 300);
}

TEST(PlannerProperty, PartialPathsEndAtTheReachablePlaceNearestTheGoal) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Problem p(seed);
    const CellIndex start = random_cell(p.grid.heights, p.random);
    if (!p.grid.open[p.grid.heights.at(start)]) continue;
    const auto middle = [](CellIndex c) -> Eigen::Vector2d {
      return {(c.x + 0.5) * 0.125, (c.y + 0.5) * 0.125};
    };
    const Eigen::Vector2d goal_m = middle(random_cell(p.grid.heights, p.random));
    const Path path = plan(p.grid, {middle(start), goal_m, true}, p.config);
    ASSERT_NE(path.status, PathStatus::none);
    if (path.status == PathStatus::complete) continue;
    const double distance_m = (path.points_m.back() - goal_m).norm();
    for (std::size_t i = 0; i < p.grid.open.size(); ++i) {
      const CellIndex end = cell_of(p.grid.heights, i);
      if (!p.grid.open[i] || (middle(end) - goal_m).norm() > distance_m - 1e-6) continue;
      const auto costs = test::plain_dijkstra(p.grid, end);
      ASSERT_EQ(costs[p.grid.heights.at(start)], kNoWay) << "cell " << i << " is nearer";
    }
  }
}

}  // namespace
}  // namespace cairn
