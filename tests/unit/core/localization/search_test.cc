#include "core/localization/search.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "core/common/angle.h"
#include "core/localization/problem.h"
#include "core/localization/wide_search.h"
#include "tests/unit/core/localization/test_ground.h"

namespace cairn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

MatchProblem random_problem(unsigned seed) {
  std::mt19937_64 random(seed);
  const test::RichGround ground;
  const Pose robot{0.4, -0.3, 0.05, 0.0, 0.0, radians(4.0)};
  RegistrationPrior prior;
  prior.T_site_submap = {0.1, 0.2, 0.0, 0.0, 0.0, radians(-3.0)};
  const SearchWindow window{.reach_m = 1.5, .yaw_rad = radians(12.0), .yaw_step_rad = radians(1.0)};
  return make_problem(test::short_term_of(ground, robot, random), prior,
                      test::long_term_of(ground, random), window, RegistrationConfig{});
}

TEST(WideSearch, FindsExactlyWhatTryingEverythingFinds) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const MatchProblem problem = random_problem(seed);
    const auto all = basins(search_all(problem, portable_kernels()), 1);
    ASSERT_FALSE(all.empty());
    for (const MatchKernels* kernels : usable_kernels()) {
      const auto found = search_wide(problem, *kernels, kInfinity, std::nullopt).best;
      ASSERT_TRUE(found) << kernels->name << ", seed " << seed;
      EXPECT_EQ(found->sum, all.front().sum) << kernels->name << ", seed " << seed;
      EXPECT_EQ(found->x, all.front().x);
      EXPECT_EQ(found->y, all.front().y);
      EXPECT_EQ(found->yaw, all.front().yaw);
    }
  }
}

TEST(WideSearch, LooksAtFewOfThePlaces) {
  const MatchProblem problem = random_problem(1);
  const auto places = static_cast<std::size_t>(problem.side() * problem.side() * problem.yaws());
  EXPECT_LT(search_wide(problem, fastest_kernels(), kInfinity, std::nullopt).bounds, places / 3);
}

TEST(WideSearch, LeavesOutWhatIsExcluded) {
  const MatchProblem problem = random_problem(2);
  const auto best = search_wide(problem, fastest_kernels(), kInfinity, std::nullopt).best;
  ASSERT_TRUE(best);
  const Excluded around{*best, 3, 3};
  const auto other = search_wide(problem, fastest_kernels(), kInfinity, around).best;
  ASSERT_TRUE(other);
  EXPECT_FALSE(around.holds(other->yaw, other->y, other->x));
  EXPECT_TRUE(better(best->sum, other->sum));
}

TEST(WideSearch, FindsNothingBelowALimitThatNothingReaches) {
  EXPECT_FALSE(search_wide(random_problem(3), fastest_kernels(), 0.0, std::nullopt).best);
}

TEST(FourthPowerMean, OfOneGoodMatchIsThatMatch) {
  MatchVolume volume{3, 1, 1, std::vector<MatchSum>(9, {1000, 10})};
  volume.sums[volume.index(0, 2, 1)] = {0, 10};
  const WeightedMean mean = fourth_power_mean(volume, 0.7);
  EXPECT_EQ(mean.good, 1U);
  EXPECT_DOUBLE_EQ(mean.x, 1.0);
  EXPECT_DOUBLE_EQ(mean.y, 2.0);
}

TEST(FourthPowerMean, WeighsGoodMatchesByTheFourthPowerOfTheirNormalisedScore) {
  MatchVolume volume{3, 1, 1, std::vector<MatchSum>(9, {1000, 10})};
  volume.sums[volume.index(0, 0, 0)] = {0, 10};
  volume.sums[volume.index(0, 0, 1)] = {200, 10};
  const double weight = 0.8 * 0.8 * 0.8 * 0.8;
  EXPECT_NEAR(fourth_power_mean(volume, 0.7).x, weight / (1.0 + weight), 1e-12);
}

TEST(FourthPowerMean, OverlooksMatchesWithTooLittleOverlap) {
  MatchVolume volume{3, 1, 5, std::vector<MatchSum>(9, {1000, 10})};
  volume.sums[0] = {0, 4};
  EXPECT_EQ(fourth_power_mean(volume, 0.0).good, 8U);
}

}  // namespace
}  // namespace cairn
