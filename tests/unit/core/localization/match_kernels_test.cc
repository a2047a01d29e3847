#include "core/localization/match_kernels.h"

#include <gtest/gtest.h>

#include <random>

namespace cairn {
namespace {

constexpr int kWidth = 200;
constexpr int kSide = 11;

std::int16_t random_height(std::mt19937& random, std::int16_t unknown) {
  std::uniform_int_distribution<int> height(-kMatchLimitMm, kMatchLimitMm);
  return random() % 3 == 0 ? unknown : static_cast<std::int16_t>(height(random));
}

std::vector<std::int16_t> random_ground(std::mt19937& random) {
  std::vector<std::int16_t> ground(std::size_t{kWidth} * kWidth);
  for (std::int16_t& height : ground) height = random_height(random, kUnknownInLong);
  return ground;
}

TurnedMap random_turned(std::mt19937& random, int blocks) {
  TurnedMap turned;
  std::uniform_int_distribution<std::uint32_t> place(0, kWidth * (kWidth - kSide - 2));
  for (int i = 0; i < blocks; ++i) {
    turned.at.push_back(place(random));
    for (int k = 0; k < TurnedMap::kBlock; ++k) {
      turned.height_mm.push_back(random_height(random, kUnknownInShort));
    }
  }
  return turned;
}

std::vector<MatchSum> square(const MatchKernels& kernels, const TurnedMap& turned,
                             const std::vector<std::int16_t>& ground) {
  std::vector<MatchSum> sums(std::size_t{kSide} * kSide);
  kernels.square(turned, ground.data(), kWidth, kSide, sums.data());
  return sums;
}

TEST(MatchKernels, AllInstructionSetsGiveTheSumsOfThePortableOne) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const auto ground = random_ground(random);
    const TurnedMap turned = random_turned(random, static_cast<int>(random() % 400));
    const auto expected = square(portable_kernels(), turned, ground);
    for (const MatchKernels* kernels : usable_kernels()) {
      EXPECT_EQ(square(*kernels, turned, ground), expected) << kernels->name << ", seed " << seed;
    }
  }
}

TEST(MatchKernels, AllInstructionSetsGiveTheSameBounds) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    auto lowest = random_ground(random);
    auto highest = lowest;
    for (std::int16_t& height : highest) {
      if (height != kUnknownInLong) height = std::min<std::int16_t>(height + 300, kMatchLimitMm);
    }
    const TurnedMap turned = random_turned(random, 300);
    const MatchSum expected = portable_kernels().bound(turned, lowest.data(), highest.data());
    for (const MatchKernels* kernels : usable_kernels()) {
      EXPECT_EQ(kernels->bound(turned, lowest.data(), highest.data()), expected)
          << kernels->name << ", seed " << seed;
    }
  }
}

TEST(MatchKernels, OnlyCellsKnownInBothMapsCountAndDifferencesAreTruncated) {
  std::vector<std::int16_t> ground(std::size_t{kWidth} * kWidth, kUnknownInLong);
  TurnedMap turned;
  turned.at = {0};
  turned.height_mm.assign(TurnedMap::kBlock, kUnknownInShort);
  turned.height_mm[0] = 100;
  turned.height_mm[1] = 100;
  turned.height_mm[2] = 100;
  ground[0] = 130;    // 30 mm apart.
  ground[1] = -5000;  // Truncated.
  ground[3] = 100;    // Unknown in the short-term map.
  for (const MatchKernels* kernels : usable_kernels()) {
    EXPECT_EQ(square(*kernels, turned, ground).front(), (MatchSum{30 + kTruncateMm, 2}))
        << kernels->name;
  }
}

}  // namespace
}  // namespace cairn
