#include "core/map/sensor_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace cairn {
namespace {

using testing::HasSubstr;

TEST(SensorModel, TheDefaultIsSound) { EXPECT_EQ(faults(SensorModel{}), ""); }

TEST(SensorModel, NamesEveryFaultAtOnce) {
  const SensorModel bad{.hit_probability = 127,
                        .miss_probability = 128,
                        .graze_probability = 128,
                        .graze_beyond_m = -1.0,
                        .min_probability = 0,
                        .max_probability = 255,
                        .tolerance_mm = 0,
                        .mean_memory_hits = 256};
  const std::string all = faults(bad);
  for (const char* name :
       {"hit_probability", "miss_probability", "graze_probability", "graze_beyond_m",
        "min_probability", "max_probability", "tolerance_mm", "mean_memory_hits"}) {
    EXPECT_THAT(all, HasSubstr(name));
  }
}

TEST(SensorModel, NamesOneFaultAlone) {
  EXPECT_EQ(faults({.tolerance_mm = -1}), "tolerance_mm must be 1 to 10000");
  EXPECT_EQ(faults({.hit_probability = 200, .max_probability = 199}),
            "max_probability must be hit_probability to 254");
}

TEST(Combine, IsEquation1RoundedToNearest) {
  for (int a = 1; a < 255; ++a) {
    for (int b = 1; b < 255; ++b) {
      const double p = a / 255.0;
      const double s = b / 255.0;
      const double exact = 255.0 * s * p / (s * p + (1 - s) * (1 - p));
      const int result = combine(static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b));
      ASSERT_LE(std::abs(result - exact), 0.5 + 1e-9) << a << " and " << b;
    }
  }
}

TEST(Combine, TwoOpinionsThatAgreeAreStrongerAndThatDisagreeWeaker) {
  EXPECT_GT(combine(170, 170), 170);
  EXPECT_LT(combine(85, 85), 85);
  EXPECT_NEAR(combine(170, 85), 127, 1);
}

TEST(Combine, CertaintyStays) {
  EXPECT_EQ(combine(0, 200), 0);
  EXPECT_EQ(combine(255, 3), 255);
}

TEST(HitsBehind, CountsTheHitsThatLeadToAProbability) {
  const SensorModel model{.max_probability = 254, .mean_memory_hits = 255};
  std::uint8_t p = model.hit_probability;
  for (int hits = 1; hits <= 6; ++hits) {
    EXPECT_EQ(hits_behind(p, model), hits) << int{p};
    p = combine(p, model.hit_probability);
  }
}

TEST(HitsBehind, IsAtLeastOneAndAtMostTheMemory) {
  const SensorModel model{.mean_memory_hits = 3};
  EXPECT_EQ(hits_behind(1, model), 1);
  EXPECT_EQ(hits_behind(model.min_probability, model), 1);
  EXPECT_EQ(hits_behind(249, model), 3);
}

TEST(HitsBehind, AtTheCapStandsForAsManyAsAreRemembered) {
  const SensorModel model;
  EXPECT_LT(hits_behind(model.max_probability - 1, model), model.mean_memory_hits);
  EXPECT_EQ(hits_behind(model.max_probability, model), model.mean_memory_hits);
  EXPECT_EQ(hits_behind(255, model), model.mean_memory_hits);
}

TEST(HitsBehind, NeverLiesWhereTheLastDigitsOfALogarithmDecide) {
  double nearest = 1.0;
  for (int h = 129; h < 255; ++h) {
    for (int p = h + 1; p < 255; ++p) {
      const double hits = std::log(p / (255.0 - p)) / std::log(h / (255.0 - h));
      nearest = std::min(nearest, std::abs(hits - std::floor(hits) - 0.5));
    }
  }
  EXPECT_GT(nearest, 1e-9);
}

}  // namespace
}  // namespace cairn
