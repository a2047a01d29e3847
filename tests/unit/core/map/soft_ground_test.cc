#include "core/map/soft_ground.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/support/ascii_grid.h"

namespace cairn {
namespace {

using test::draw;

const VehicleLimits kLimits{100, 100, 0.0};

SoftGround assessed(const HeightGrid& grid, const SoftLimits& soft = {},
                    const TerrainKernels& kernels = *usable_terrain_kernels().front()) {
  SoftGround ground;
  assess(grid, kLimits, soft, ground, kernels);
  return ground;
}

/// Steps and slopes, now and then a cliff, heights around `level_mm`; a fifth is unknown.
HeightGrid random_grid(unsigned seed, std::int32_t level_mm = 0) {
  std::mt19937 random(seed);
  const auto below = [&](unsigned limit) { return static_cast<int>(random() % limit); };
  HeightGrid grid = empty_grid({-3, 5}, {-3 + below(90), 5 + below(40)}, 125).value();
  const int cliffs = 1 + below(200);
  for (std::size_t i = 0; i < grid.height_mm.size(); ++i) {
    grid.height_mm[i] = level_mm + below(400) - 200 + (below(cliffs) == 0 ? below(40'000) : 0);
    grid.probability[i] = below(5) == 0 ? 0 : static_cast<std::uint8_t>(1 + below(255));
  }
  return grid;
}

struct Judged {
  std::vector<CellClass> classes;
  SoftGround ground;
};

Judged judged(const HeightGrid& grid, const VehicleLimits& limits, const SoftLimits& soft,
              const TerrainKernels& kernels) {
  Judged all;
  judge(grid, limits, soft, all.classes, all.ground, kernels);
  return all;
}

void expect_same_everywhere(const HeightGrid& grid, const VehicleLimits& limits,
                            const SoftLimits& soft, const std::string& which) {
  const Judged expected = judged(grid, limits, soft, portable_terrain_kernels());
  for (const TerrainKernels* kernels : usable_terrain_kernels()) {
    const Judged all = judged(grid, limits, soft, *kernels);
    ASSERT_EQ(all.classes, expected.classes) << kernels->name << " " << which;
    ASSERT_EQ(all.ground.obstacle, expected.ground.obstacle) << kernels->name << " " << which;
    ASSERT_EQ(all.ground.roughness_mm, expected.ground.roughness_mm)
        << kernels->name << " " << which;
    ASSERT_EQ(all.ground.slope_percent, expected.ground.slope_percent)
        << kernels->name << " " << which;
  }
}

TEST(SoftGround, IsTheSameInEveryInstructionSet) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    SoftLimits soft;
    soft.wheel_base_m = 0.1 + 0.01 * (seed % 150);
    soft.sigma_mm = 1.0 + seed % 7 * 100.0;
    const VehicleLimits limits{static_cast<std::int32_t>(seed % 5 * 60), 80, 0.0};
    const auto level_mm = static_cast<std::int32_t>(seed % 9) * 4'000'000;
    expect_same_everywhere(random_grid(seed, level_mm), limits, soft, std::to_string(seed));
  }
}

TEST(SoftGround, IsTheSameWhereHeightsAreFartherApartThan16BitsHold) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    HeightGrid grid = random_grid(seed);
    std::mt19937 random(seed + 1000);
    const std::int32_t ends[] = {-32768, 32767, -16001, 16000, 100'000'000, -100'000'000};
    for (int i = 0; i < 6; ++i) {
      grid.height_mm[random() % grid.height_mm.size()] = ends[random() % 6];
    }
    expect_same_everywhere(grid, {100, 100, 0.0}, {}, std::to_string(seed));
  }
}

TEST(SoftGround, IsTheSameOnMapsWiderThanABlockAndOnLongSlopes) {
  HeightGrid grid = empty_grid({0, 0}, {2 * TerrainBlock::kMostWidth + 77, 30}, 125).value();
  std::mt19937 random(3);
  for (std::size_t i = 0; i < grid.height_mm.size(); ++i) {
    grid.height_mm[i] = static_cast<std::int32_t>(i % 9000 * 7 + random() % 200);
    grid.probability[i] = random() % 40 == 0 ? 0 : 200;
  }
  expect_same_everywhere(grid, {100, 100, 0.0}, {}, "wide");
  HeightGrid tall = empty_grid({0, 0}, {40, 3000}, 125).value();
  for (std::size_t i = 0; i < tall.height_mm.size(); ++i) {
    tall.height_mm[i] = static_cast<std::int32_t>(i + random() % 200);
    tall.probability[i] = random() % 40 == 0 ? 0 : 200;
  }
  expect_same_everywhere(tall, {100, 100, 0.0}, {}, "tall");
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
