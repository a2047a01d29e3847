#include "core/localization/match_kernels.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace cairn {
namespace {

/// `apart_mm` is above kOverlapLimitMm exactly when one of the two cells is unknown.
inline void count_cell(int apart_mm, MatchSum& sum) {
  if (apart_mm > kOverlapLimitMm) return;
  sum.difference_mm += static_cast<std::uint32_t>(std::min(apart_mm, kTruncateMm));
  ++sum.overlap;
}

template <class Apart>
MatchSum sum_of(const TurnedMap& turned, const Apart& apart_mm) {
  MatchSum sum;
  const std::int16_t* cells = turned.height_mm.data();
  for (const std::uint32_t at : turned.at) {
    for (std::uint32_t i = 0; i < TurnedMap::kBlock; ++i) {
      count_cell(apart_mm(int{cells[i]}, at + i), sum);
    }
    cells += TurnedMap::kBlock;
  }
  return sum;
}

void portable_square(const TurnedMap& turned, const std::int16_t* long_term, int width, int side,
                     MatchSum* sums) {
  for (int shift = 0; shift < side * side; ++shift) {
    const std::int16_t* there = long_term + std::ptrdiff_t{shift / side} * width + shift % side;
    sums[shift] = sum_of(
        turned, [there](int height_mm, std::uint32_t i) { return std::abs(height_mm - there[i]); });
  }
}

MatchSum portable_bound(const TurnedMap& turned, const std::int16_t* lowest,
                        const std::int16_t* highest) {
  return sum_of(turned, [=](int height_mm, std::uint32_t i) {
    return std::max({height_mm - highest[i], lowest[i] - height_mm, 0});
  });
}

}  // namespace

const MatchKernels& portable_kernels() {
  static constexpr MatchKernels kKernels{"portable", portable_square, portable_bound};
  return kKernels;
}

const std::vector<const MatchKernels*>& usable_kernels() {
  static const std::vector<const MatchKernels*> all = [] {
    std::vector<const MatchKernels*> usable{avx512_kernels(), avx2_kernels(), &portable_kernels()};
    std::erase(usable, nullptr);
    return usable;
  }();
  return all;
}

}  // namespace cairn
