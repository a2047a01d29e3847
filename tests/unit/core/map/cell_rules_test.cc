#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/map/update.h"

namespace cairn {
namespace {

const SensorModel kModel;
using Pass = CellRules::Pass;
const CellRules kRules{SensorModel{}};

TEST(AfterHit, AnUnknownCellTakesTheHit) {
  EXPECT_EQ(kRules.after_hit(Cell{}, -700), (Cell{-700, kModel.hit_probability}));
}

TEST(AfterHit, AnUnknownCellForgetsTheHeightItHad) {
  EXPECT_EQ(kRules.after_hit(Cell{9000, 0}, 100), (Cell{100, kModel.hit_probability}));
}

TEST(AfterHit, AHitHigherThanTheToleranceReplacesHoweverSureTheCellWas) {
  EXPECT_EQ(kRules.after_hit(Cell{1000, 250}, 1051), (Cell{1051, kModel.hit_probability}));
}

TEST(AfterHit, WithinTheToleranceProbabilitiesCombine) {
  for (const std::int32_t height : {950, 1000, 1050}) {
    EXPECT_EQ(kRules.after_hit(Cell{1000, 166}, height).probability, combine(166, 166));
  }
}

TEST(AfterHit, TheSecondHitMeetsTheFirstHalfWay) {
  EXPECT_EQ(kRules.after_hit(Cell{1000, kModel.hit_probability}, 1040).height_mm, 1020);
  EXPECT_EQ(kRules.after_hit(Cell{1000, kModel.hit_probability}, 960).height_mm, 980);
}

TEST(AfterHit, ALowerHitBeyondTheToleranceIsIgnored) {
  const Cell cell{1000, 166};
  EXPECT_EQ(kRules.after_hit(cell, 949), cell);
}

TEST(AfterHit, ProbabilityStopsAtTheCap) {
  Cell cell;
  for (int i = 0; i < 100; ++i) cell = kRules.after_hit(cell, 1000);
  EXPECT_EQ(cell, (Cell{1000, kModel.max_probability}));
}

TEST(AfterHit, HeightsFarApartDoNotOverflow) {
  EXPECT_EQ(kRules.after_hit(Cell{-2'000'000'000, 99}, 2'000'000'000).height_mm, 2'000'000'000);
  EXPECT_EQ(kRules.after_hit(Cell{2'000'000'000, 99}, -2'000'000'000).height_mm, 2'000'000'000);
}

TEST(AfterHit, TheMeanDoesNotStallBesideTheTruth) {
  Cell cell{1005, kModel.max_probability};
  for (int i = 0; i < 5; ++i) cell = kRules.after_hit(cell, 1000);
  EXPECT_EQ(cell.height_mm, 1000);
  cell.height_mm = 995;
  for (int i = 0; i < 5; ++i) cell = kRules.after_hit(cell, 1000);
  EXPECT_EQ(cell.height_mm, 1000);
}

TEST(AfterHit, TwoHundredNoisyHitsLandNearTheTruthAndFavourNeitherSide) {
  constexpr unsigned kSeed = 1;
  constexpr int kRuns = 400;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<std::int32_t> noise_mm(-30, 30);
  double sum = 0.0;
  double squares = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    Cell cell;
    for (int i = 0; i < 200; ++i) cell = kRules.after_hit(cell, 1000 + noise_mm(random));
    const double off = cell.height_mm - 1000;
    sum += off;
    squares += off * off;
  }
  EXPECT_LT(std::abs(sum / kRuns), 0.7) << "bias [mm], seed " << kSeed;
  EXPECT_LT(std::sqrt(squares / kRuns), 6.0) << "spread [mm], seed " << kSeed;
}

TEST(AfterHit, IsTheSameAsThePlainFormula) {
  for (int p = 1; p < 255; ++p) {
    const Cell cell{1000, static_cast<std::uint8_t>(p)};
    const double count = hits_behind(cell.probability, kModel) + 1;
    for (std::int32_t off = -50; off <= 50; ++off) {
      const Cell after = kRules.after_hit(cell, 1000 + off);
      const double exact = off / count;
      const double step = off == 0 ? 0.0 : std::copysign(std::max(1.0, std::abs(exact)), exact);
      ASSERT_LE(std::abs(after.height_mm - 1000 - step), 0.5) << p << " " << off;
    }
  }
}

TEST(AfterPass, BelowTheSurfaceTheProbabilityFallsAndTheHeightStays) {
  EXPECT_EQ(kRules.after_pass(Cell{1000, 200}, kRules.pass_of(Cell{1000, 200}, 949, false)),
            (Cell{1000, combine(200, kModel.miss_probability)}));
}

TEST(AfterPass, WithinTheToleranceOrAboveNothingChanges) {
  const Cell cell{1000, 200};
  for (const std::int32_t beam : {950, 1000, 5000}) {
    EXPECT_EQ(kRules.pass_of(cell, beam, false), Pass::above);
  }
  EXPECT_EQ(kRules.after_pass(cell, Pass::above), cell);
}

TEST(AfterPass, ABeamThatGoesOnGrazesUpToTheSurfaceAndNotAbove) {
  const Cell cell{1000, 200};
  EXPECT_EQ(kRules.pass_of(cell, 949, true), Pass::below);
  EXPECT_EQ(kRules.pass_of(cell, 950, true), Pass::grazing);
  EXPECT_EQ(kRules.pass_of(cell, 1000, true), Pass::grazing);
  EXPECT_EQ(kRules.pass_of(cell, 1001, true), Pass::above);
}

TEST(AfterPass, AGrazingBeamSaysLessThanOneBelow) {
  const Cell cell{1000, 200};
  EXPECT_LT(kRules.after_pass(cell, Pass::grazing).probability, 200);
  EXPECT_GT(kRules.after_pass(cell, Pass::grazing).probability,
            kRules.after_pass(cell, Pass::below).probability);
}

TEST(AfterPass, AnUnknownCellStaysUnknown) {
  EXPECT_EQ(kRules.pass_of(Cell{}, -5000, true), Pass::above);
}

TEST(AfterPass, SeenThroughOftenEnoughEvenASureCellIsUnknownAgain) {
  Cell cell{1000, kModel.max_probability};
  int passes = 0;
  while (cell.known() && passes < 100) {
    cell = kRules.after_pass(cell, Pass::below);
    ++passes;
    EXPECT_TRUE(!cell.known() || cell.probability >= kModel.min_probability);
  }
  EXPECT_FALSE(cell.known());
  EXPECT_GT(passes, 5) << "one stray beam must not erase a wall";
  EXPECT_LT(passes, 20);
}

TEST(AfterPass, TheNextHitReplacesASeenThroughCellEvenFromBelow) {
  const Cell cell = kRules.after_pass(Cell{1000, kModel.min_probability}, Pass::below);
  ASSERT_FALSE(cell.known());
  EXPECT_EQ(kRules.after_hit(cell, 20), (Cell{20, kModel.hit_probability}));
}

TEST(CellRules, EvenTheWeakestModelLearnsAndForgets) {
  const CellRules weak(
      SensorModel{.hit_probability = 128, .miss_probability = 127, .graze_probability = 127});
  Cell cell;
  for (int i = 0; i < 300; ++i) cell = weak.after_hit(cell, 0);
  EXPECT_EQ(cell.probability, weak.model().max_probability);
  for (int i = 0; i < 300; ++i)
    cell = weak.after_pass(cell, i % 2 == 0 ? Pass::below : Pass::grazing);
  EXPECT_FALSE(cell.known());
}

TEST(CellRules, ACertainCellFromElsewhereObeysToo) {
  EXPECT_EQ(kRules.after_hit(Cell{0, 255}, 0).probability, kModel.max_probability);
  EXPECT_LT(kRules.after_pass(Cell{0, 255}, Pass::below).probability, 254);
}

}  // namespace
}  // namespace cairn
