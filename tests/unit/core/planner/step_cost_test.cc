#include <gtest/gtest.h>

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

TEST(StepCost, OnLevelGroundIsTheDistance) {
  const PlannerConfig config = point_robot();
  const DrivableGrid grid = drivable({"..", ".."}, config);
  EXPECT_EQ(step_cost(grid, config, 0, kEast), 1250U);
  EXPECT_EQ(step_cost(grid, config, 0, kNorthEast), 1768U);
}

TEST(StepCost, AddsEffortByTheDirection) {
  const PlannerConfig config = point_robot();  // Climbing 8 m/m, descending 2 m/m.
  const DrivableGrid grid = drivable({"01"}, config, 50);
  EXPECT_EQ(step_cost(grid, config, 0, kEast), 1250U + 4000U);
  EXPECT_EQ(step_cost(grid, config, 1, kWest), 1250U + 1000U);
}

TEST(StepCost, ForbidsAStepBeyondTheLimitInItsDirectionOnly) {
  PlannerConfig config = point_robot();
  config.limits = {50, 200, 0.0};
  const DrivableGrid grid = drivable({"02"}, config);
  EXPECT_EQ(step_cost(grid, config, 0, kEast), kNoWay);
  EXPECT_EQ(step_cost(grid, config, 1, kWest), 1250U + 4000U);
}

TEST(StepCost, AllowsAStepOfExactlyTheLimit) {
  PlannerConfig config = point_robot();
  config.limits = {200, 200, 0.0};
  const DrivableGrid grid = drivable({"02"}, config);
  EXPECT_NE(step_cost(grid, config, 0, kEast), kNoWay);
  EXPECT_NE(step_cost(grid, config, 1, kWest), kNoWay);
}

TEST(StepCost, PricesEachHalfByTheCellItLiesIn) {
  PlannerConfig config = point_robot();
  config.unknown = UnknownGround::allowed;
  config.unknown_price = 3.0;
  const DrivableGrid grid = drivable({"9??"}, config);
  EXPECT_EQ(step_cost(grid, config, 0, kEast), 2500U);
  EXPECT_EQ(step_cost(grid, config, 1, kEast), 3750U);
  EXPECT_EQ(step_cost(grid, config, 1, kWest), 2500U) << "unknown heights set no limit";
}

TEST(StepCost, CutsNoCorner) {
  const PlannerConfig config = point_robot();
  EXPECT_EQ(step_cost(drivable({"#.", ".."}, config), config, 0, kNorthEast), kNoWay);
  EXPECT_EQ(step_cost(drivable({"..", ".#"}, config), config, 0, kNorthEast), kNoWay);
  EXPECT_NE(step_cost(drivable({"..", "?."}, config), config, 0, kNorthEast), kNoWay)
      << "the cell itself need not be open";
}

TEST(StepCost, EndsAtTheMapsEdge) {
  const PlannerConfig config = point_robot();
  const DrivableGrid grid = drivable({"."}, config);
  for (int d = 0; d < 8; ++d) EXPECT_EQ(step_cost(grid, config, 0, d), kNoWay);
}

TEST(StepCost, ThatDoesNotFitIsNoWay) {
  PlannerConfig config = point_robot();
  config.limits = {2'000'000'000, 2'000'000'000, 0.0};
  DrivableGrid grid = drivable({".."}, config);
  grid.heights.height_mm = {-1'000'000'000, 1'000'000'000};
  EXPECT_EQ(step_cost(grid, config, 0, kEast), kNoWay);
}

}  // namespace
}  // namespace cairn
