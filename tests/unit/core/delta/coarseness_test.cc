#include "core/delta/coarseness.h"

#include <gtest/gtest.h>

#include <random>

#include "core/map/sensor_model.h"

namespace cairn {
namespace {

TEST(Coarseness, LevelsRiseFromTheModelsLeastToItsMost) {
  const SensorModel model;
  for (int levels = 2; levels <= kMaxLevels; ++levels) {
    EXPECT_EQ(probability_of(0, levels), model.min_probability);
    EXPECT_EQ(probability_of(levels - 1, levels), model.max_probability);
    for (int level = 1; level < levels; ++level) {
      EXPECT_GT(probability_of(level, levels), probability_of(level - 1, levels));
    }
  }
}

TEST(Coarseness, ALevelsProbabilityIsOfThatLevel) {
  for (int levels = 2; levels <= kMaxLevels; ++levels) {
    for (int level = 0; level < levels; ++level) {
      EXPECT_EQ(level_of(probability_of(level, levels), levels), level);
    }
  }
}

TEST(Coarseness, WhatIsToldIsOfTheCoarsenessAndNearlyTrue) {
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const Coarseness coarseness{1 + i % 30, 2 + i % 15};
    const Cell exact{static_cast<int>(random() % 60'000) - 30'000,
                     static_cast<std::uint8_t>(1 + random() % 255)};
    const Cell told = coarse(exact, {}, coarseness);
    ASSERT_TRUE(representable(told, coarseness));
    ASSERT_LE(2 * std::abs(told.height_mm - exact.height_mm), coarseness.quantum_mm);
    const Cell next{exact.height_mm + static_cast<int>(random() % 9) - 4, exact.probability};
    const Cell again = coarse(next, told, coarseness);
    ASSERT_TRUE(representable(again, coarseness));
    ASSERT_LT(std::abs(again.height_mm - next.height_mm), std::max(coarseness.quantum_mm, 1));
  }
}

TEST(Coarseness, WhatMovesLessThanAQuantumAndALevelIsNoNews) {
  const Cell told = coarse({1234, 200}, {}, {});
  EXPECT_EQ(told.height_mm, 1230);
  for (int off = -9; off <= 9; ++off) EXPECT_EQ(coarse({1230 + off, 202}, told, {}), told);
  EXPECT_EQ(coarse({1240, 200}, told, {}).height_mm, 1240);
  EXPECT_EQ(coarse({1220, 200}, told, {}).height_mm, 1220);
}

TEST(Coarseness, ASurfaceBeyondDoubtBecomesTold) {
  const Cell nearly = coarse({0, 240}, {}, {});
  EXPECT_LT(nearly.probability, 250);
  EXPECT_EQ(coarse({0, 250}, nearly, {}).probability, 250);
}

TEST(Coarseness, UnknownAndCertainStayWhatTheyAre) {
  EXPECT_EQ(coarse({77, 0}, {50, 200}, {}), Cell{});
  EXPECT_EQ(coarse({77, 255}, {50, 200}, {}).probability, 255);
}

TEST(Coarseness, ExactChangesNothing) {
  const Cell cell{-31'234, 77};
  EXPECT_EQ(coarse(cell, {-31'233, 78}, kExact), cell);
  EXPECT_TRUE(representable(cell, kExact));
}

TEST(Coarseness, FaultsAreNamed) {
  EXPECT_EQ(faults(Coarseness{}), "");
  EXPECT_NE(faults(Coarseness{0, 16}), "");
  EXPECT_NE(faults(Coarseness{256, 16}), "");
  EXPECT_NE(faults(Coarseness{10, 1}), "");
  EXPECT_NE(faults(Coarseness{10, 17}), "");
}

}  // namespace
}  // namespace cairn
