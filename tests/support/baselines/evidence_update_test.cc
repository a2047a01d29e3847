#include "tests/support/baselines/evidence_update.h"

#include <gtest/gtest.h>

namespace cairn::baselines {
namespace {

TEST(Bayes, IsEquation1) {
  // From even odds one reading gives its own probability, two multiply their odds.
  EXPECT_NEAR(Bayes::after_hit(Bayes::kUnknown), Bayes::kHit, 1);
  const double odds = 166.0 / 89.0 * 166.0 / 89.0;
  EXPECT_NEAR(Bayes::occupied(Bayes::after_hit(Bayes::kHit)), odds / (1 + odds), 0.5 / 255);
}

TEST(Bayes, APassTakesBackWhatItsOddsAreWorth) {
  const double odds = 166.0 / 89.0 * 102.0 / 153.0;
  EXPECT_NEAR(Bayes::occupied(Bayes::after_pass(Bayes::kHit)), odds / (1 + odds), 0.5 / 255);
  EXPECT_LT(Bayes::after_pass(Bayes::kUnknown), Bayes::kUnknown);
}

TEST(Bayes, NeverBecomesCertain) {
  Bayes::Belief belief = Bayes::kUnknown;
  for (int i = 0; i < 100; ++i) belief = Bayes::after_hit(belief);
  EXPECT_EQ(belief, Bayes::kHighest);
  for (int i = 0; i < 100; ++i) belief = Bayes::after_pass(belief);
  EXPECT_EQ(belief, Bayes::kLowest);
}

TEST(Himm, RisesByThreeFallsByOneAndStaysWithinItsBounds) {
  EXPECT_EQ(Himm::after_hit(0), 3);
  EXPECT_EQ(Himm::after_hit(14), 15);
  EXPECT_EQ(Himm::after_pass(3), 2);
  EXPECT_EQ(Himm::after_pass(0), 0);
}

TEST(DempsterShafer, CombinesAsInTheTextbook) {
  // 0.6 occupied with 0.5 empty: conflict 0.3, so 0.3/0.7 occupied and 0.2/0.7 empty.
  const Masses result = combine({.occupied = 0.6F}, {.empty = 0.5F});
  EXPECT_NEAR(result.occupied, 0.3 / 0.7, 1e-6);
  EXPECT_NEAR(result.empty, 0.2 / 0.7, 1e-6);
}

TEST(DempsterShafer, TellsIgnoranceFromConflict) {
  const Masses conflict = combine({.occupied = 0.9F}, {.empty = 0.9F});
  EXPECT_NEAR(DempsterShafer::occupied(conflict), 0.5, 1e-6);
  EXPECT_NEAR(DempsterShafer::occupied(DempsterShafer::kUnknown), 0.5, 1e-6);
  EXPECT_GT(conflict.occupied + conflict.empty, 0.9F);
}

TEST(DempsterShafer, AWorldThatChangedIsLearned) {
  Masses belief = DempsterShafer::kUnknown;
  for (int i = 0; i < 200; ++i) belief = DempsterShafer::after_hit(belief);
  EXPECT_GT(DempsterShafer::occupied(belief), 0.95);
  for (int i = 0; i < 200; ++i) belief = DempsterShafer::after_pass(belief);
  EXPECT_LT(DempsterShafer::occupied(belief), 0.05);
}

}  // namespace
}  // namespace cairn::baselines
