#include "core/map/soft_ground.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/ascii_grid.h"

namespace cairn {
namespace {

using test::draw;

const VehicleLimits kLimits{100, 100, 0.0};

SoftGround assessed(const HeightGrid& grid, const SoftLimits& soft = {},
                    const SoftKernels& kernels = *usable_soft_kernels().front()) {
  SoftGround ground;
  assess(grid, kLimits, soft, ground, kernels);
  return ground;
}

HeightGrid random_grid(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](unsigned limit) { return static_cast<int>(random() % limit); };
  HeightGrid grid = empty_grid({-3, 5}, {-3 + below(90), 5 + below(40)}, 125).value();
  for (std::size_t i = 0; i < grid.height_mm.size(); ++i) {
    grid.height_mm[i] = below(400) - 200 + (below(9) == 0 ? 90'000'000 : 0);
    grid.probability[i] = below(5) == 0 ? 0 : static_cast<std::uint8_t>(1 + below(255));
  }
  return grid;
}

TEST(SoftGround, IsTheSameInEveryInstructionSet) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const HeightGrid grid = random_grid(seed);
    SoftLimits soft;
    soft.wheel_base_m = 0.1 + 0.01 * (seed % 150);
    const SoftGround expected = assessed(grid, soft, portable_soft_kernels());
    for (const SoftKernels* kernels : usable_soft_kernels()) {
      const SoftGround ground = assessed(grid, soft, *kernels);
      ASSERT_EQ(ground.obstacle, expected.obstacle) << kernels->name << " seed " << seed;
      ASSERT_EQ(ground.roughness_mm, expected.roughness_mm) << kernels->name << " seed " << seed;
      ASSERT_EQ(ground.slope_percent, expected.slope_percent) << kernels->name << " seed " << seed;
    }
  }
}

/// The obstacle probability [1/255] of a single step.
int obstacle_at(std::int32_t step_mm, std::uint8_t probability, double sigma_mm) {
  HeightGrid grid = draw({"01"}, step_mm).grid;
  grid.probability = {255, probability};
  SoftLimits soft;
  soft.sigma_mm = sigma_mm;
  return assessed(grid, soft).obstacle[1];
}

TEST(SoftGround, AStepJustBeyondTheLimitIsNotSurelyAnObstacle) {
  EXPECT_EQ(obstacle_at(20, 255, 15), 0);
  EXPECT_NEAR(obstacle_at(100, 255, 15), 127, 2);
  EXPECT_GT(obstacle_at(105, 255, 15), 128);
  EXPECT_LT(obstacle_at(105, 255, 15), 200);
  EXPECT_EQ(obstacle_at(300, 255, 15), 255);
}

TEST(SoftGround, ABetterSensorAndASurerCellDecideSooner) {
  EXPECT_GT(obstacle_at(110, 255, 5), obstacle_at(110, 255, 30));
  EXPECT_LT(obstacle_at(90, 255, 5), obstacle_at(90, 255, 30));
  EXPECT_GT(obstacle_at(300, 255, 15), obstacle_at(300, 90, 15));
}

TEST(SoftGround, ARampHasSlopeButNoRoughnessAndABumpTheReverse) {
  const HeightGrid ramp = draw({"012345678", "012345678", "012345678"}, 25).grid;
  const SoftGround on_ramp = assessed(ramp);
  const std::size_t middle = ramp.at({4, 1});
  EXPECT_EQ(on_ramp.roughness_mm[middle], 0);
  EXPECT_NEAR(on_ramp.slope_percent[middle], 20, 2);
  const HeightGrid bump = draw({".........", "....1....", "........."}, 60).grid;
  const SoftGround on_bump = assessed(bump);
  EXPECT_EQ(on_bump.roughness_mm[middle], 60);
  EXPECT_EQ(on_bump.slope_percent[middle], 0);
}

TEST(SoftGround, SaysNothingOfUnknownCells) {
  const SoftGround ground = assessed(draw({"#?#", "???", "#?#"}).grid);
  EXPECT_EQ(ground.obstacle[4], 0);
  EXPECT_EQ(ground.roughness_mm[4], 0);
  EXPECT_EQ(ground.slope_percent[4], 0);
}

}  // namespace
}  // namespace cairn
