#include <gtest/gtest.h>

#include <cmath>

#include "core/planner/plan.h"
#include "tests/support/ascii_grid.h"

namespace cairn {
namespace {

using test::AsciiGrid;
using test::draw;

PlannerConfig point_robot() {
  PlannerConfig config;
  config.limits = {100, 100, 0.0};
  config.climb_effort = config.descend_effort = 0.0;
  return config;
}

double price_at(const DrivableGrid& grid, CellIndex cell) {
  return 1.0 * grid.ground.price[grid.ground_at(cell)] / kCellUnits;
}

TEST(SoftPrice, GroundWithoutAnyCostsItsLength) {
  const DrivableGrid grid = make_drivable(draw({"...", ".1."}).grid, point_robot());
  for (int x = 0; x < 3; ++x) EXPECT_EQ(price_at(grid, {x, 0}), 1.0);
}

TEST(SoftPrice, FallsWithTheDistanceFromAnObstacle) {
  PlannerConfig config = point_robot();
  config.closeness_price = 4.0;
  config.closeness_m = 0.5;
  const DrivableGrid grid = make_drivable(draw({"#......", "......."}).grid, config);
  EXPECT_NEAR(price_at(grid, {1, 1}), 1 + 4 * 0.75, 0.01);
  EXPECT_NEAR(price_at(grid, {2, 1}), 1 + 4 * 0.5, 0.01);
  EXPECT_NEAR(price_at(grid, {1, 0}), 1 + 4 * (1 - std::sqrt(2) / 4), 0.01);
  EXPECT_NEAR(price_at(grid, {4, 1}), 1.0, 0.01);
  EXPECT_NEAR(price_at(grid, {6, 1}), 1.0, 0.01);
}

TEST(SoftPrice, MakesStepsNearTheLimitDear) {
  PlannerConfig config = point_robot();
  config.obstacle_price = 10.0;
  const DrivableGrid grid = make_drivable(draw({"..1.."}, 95).grid, config);
  EXPECT_GT(price_at(grid, {2, 0}), 3.0);
  EXPECT_EQ(price_at(grid, {0, 0}), 1.0);
}

TEST(SoftPrice, WeightsOfTheOperatorLeadAround) {
  const AsciiGrid drawn = draw({".......", ".......", "S.....G"});
  WeightLayer weights(21, 0);
  for (std::size_t x = 2; x < 5; ++x) weights[x] = 160;
  const PlannerConfig config = point_robot();
  const auto middle = [](CellIndex c) -> Eigen::Vector2d {
    return {(c.x + 0.5) * 0.125, (c.y + 0.5) * 0.125};
  };
  const PlanRequest request{middle(drawn.cell('S')), middle(drawn.cell('G'))};
  const auto highest = [&](const Path& path) {
    double y = 0.0;
    for (const auto& p : path.points_m) y = std::max(y, p.y());
    return y;
  };
  EXPECT_LT(highest(plan(make_drivable(drawn.grid, config), request, config)), 0.125);
  EXPECT_GE(highest(plan(make_drivable(drawn.grid, config, weights), request, config)), 0.12);
}

TEST(SoftPrice, NeverGetsTooLargeForItsWord) {
  PlannerConfig config = point_robot();
  config.closeness_price = config.obstacle_price = config.roughness_price = config.slope_price = 30;
  const DrivableGrid grid = make_drivable(draw({"#9.8"}, 12).grid, config, WeightLayer(4, 255));
  for (int x = 1; x < 4; ++x) EXPECT_LE(price_at(grid, {x, 0}), 33.3);
}

}  // namespace
}  // namespace cairn
