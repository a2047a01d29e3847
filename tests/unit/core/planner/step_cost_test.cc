#include <gtest/gtest.h>

#include <cmath>

#include "core/planner/stencil.h"
#include "core/planner/trulla.h"
#include "tests/support/ascii_grid.h"

namespace cairn {
namespace {

using test::draw;

constexpr int kEast = 0;
constexpr int kNorthEast = 1;
constexpr int kWest = 4;

PlannerConfig point_robot() {
  PlannerConfig config;
  config.limits = {100, 100, 0.0};
  return config;
}

DrivableGrid drivable(const std::vector<std::string>& rows, const PlannerConfig& config,
                      int step_mm = 100) {
  return make_drivable(draw(rows, step_mm).grid, config);
}

constexpr CellIndex kFirst{0, 0};
constexpr CellIndex kSecond{1, 0};

TEST(StepCost, OnLevelGroundIsTheDistance) {
  const DrivableGrid grid = drivable({"..", ".."}, point_robot());
  EXPECT_EQ(step_cost(grid, kFirst, kEast), 985U);
  EXPECT_EQ(step_cost(grid, kFirst, kNorthEast), 1393U);
}

TEST(StepCost, AddsEffortByTheDirection) {
  const PlannerConfig config = point_robot();  // Climbing 8 m/m, descending 2 m/m.
  const DrivableGrid grid = drivable({"01"}, config, 50);
  EXPECT_NEAR(step_cost(grid, kFirst, kEast) * grid.unit_m(), 0.125 + 0.05 * 8, 1e-3);
  EXPECT_NEAR(step_cost(grid, kSecond, kWest) * grid.unit_m(), 0.125 + 0.05 * 2, 1e-3);
}

TEST(StepCost, ForbidsAStepBeyondTheLimitInItsDirectionOnly) {
  PlannerConfig config = point_robot();
  config.limits = {50, 200, 0.0};
  const DrivableGrid grid = drivable({"02"}, config);
  EXPECT_EQ(step_cost(grid, kFirst, kEast), kNoWay);
  EXPECT_NEAR(step_cost(grid, kSecond, kWest) * grid.unit_m(), 0.125 + 0.2 * 2, 1e-3);
}

TEST(StepCost, AllowsAStepOfExactlyTheLimit) {
  PlannerConfig config = point_robot();
  config.limits = {200, 200, 0.0};
  const DrivableGrid grid = drivable({"02"}, config);
  EXPECT_NE(step_cost(grid, kFirst, kEast), kNoWay);
  EXPECT_NE(step_cost(grid, kSecond, kWest), kNoWay);
}

TEST(StepCost, IsPricedByTheCellThatItLeaves) {
  PlannerConfig config = point_robot();
  config.unknown = UnknownGround::allowed;
  config.unknown_price = 3.0;
  const DrivableGrid grid = drivable({"9??"}, config);
  EXPECT_EQ(step_cost(grid, kFirst, kEast), 985U);
  EXPECT_EQ(step_cost(grid, kSecond, kEast), 3 * 985U);
  EXPECT_EQ(step_cost(grid, kSecond, kWest), 3 * 985U) << "unknown heights set no limit";
}

TEST(StepCost, CutsNoCorner) {
  const PlannerConfig config = point_robot();
  EXPECT_EQ(step_cost(drivable({"#.", ".."}, config), kFirst, kNorthEast), kNoWay);
  EXPECT_EQ(step_cost(drivable({"..", ".#"}, config), kFirst, kNorthEast), kNoWay);
  EXPECT_NE(step_cost(drivable({"..", ".."}, config), kFirst, kNorthEast), kNoWay);
}

TEST(StepCost, EndsAtTheMapsEdge) {
  const DrivableGrid grid = drivable({"."}, point_robot());
  for (int d = 0; d < 8; ++d) EXPECT_EQ(step_cost(grid, kFirst, d), kNoWay);
}

/// The rule that makes a field unique.
TEST(ThroughTriangle, NeverGetsCheaperWhenANeighbourGetsDearer) {
  for (std::int32_t price : {985, 986, 1000, 1393, 2047, 4096, 9999, 20011, 29550, 32767}) {
    ASSERT_EQ(straight_units(price, 0), price);
    for (std::int32_t gap = -3; gap < 2 * price; ++gap) {
      const std::int32_t here = through_triangle(100'000 + gap, 100'000, price);
      ASSERT_GE(through_triangle(100'001 + gap, 100'000, price), here) << price << ' ' << gap;
      ASSERT_GE(through_triangle(100'000 + gap, 100'001, price), here) << price << ' ' << gap;
    }
  }
}

TEST(ThroughTriangle, IsTheBestOfAllStraightWays) {
  const std::int32_t price = 9850;
  for (std::int32_t gap = -price; gap < 2 * price; gap += 101) {
    double best = HUGE_VAL;
    for (int i = 0; i <= 1000; ++i) {
      const double t = i / 1000.0;
      best = std::min(best, price * std::hypot(1, t) + (1 - t) * gap);
    }
    EXPECT_NEAR(through_triangle(50'000 + gap, 50'000, price), 50'000 + best, 1.0) << gap;
  }
}

}  // namespace
}  // namespace cairn
