// The kernels with 256 and 512 bits. Differences of 16 bits never overflow (see match_raster.h), so
// |a - b|, the truncation and the test for an unknown cell are one instruction each for 16 or 32
// cells; 16-bit lanes are emptied into 32 bits before they can overflow.
#include "core/localization/match_kernels.h"

#if defined(__x86_64__)
#include <immintrin.h>

#include <algorithm>

// GCC 12's own headers of AVX-512 begin some results from an undefined register on purpose.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"

namespace cairn {
namespace {

constexpr int kBlock = TurnedMap::kBlock;

/// Every unknown cell was counted as a full difference.
MatchSum without_unknown(std::uint32_t difference_mm, std::uint32_t unknown, std::uint32_t cells) {
  return {difference_mm - unknown * static_cast<std::uint32_t>(kTruncateMm), cells - unknown};
}

/// Some of a turned map's blocks: as many as 16-bit lanes can take.
struct Part {
  int begin, end;
};

/// Adds what a part says at one more shifts than the function's place in its table, which share
/// the loads of the short-term map.
using FewShifts = void (*)(const TurnedMap&, Part, const std::int16_t*, MatchSum*);
constexpr int kMostShifts = 6;

/// As few groups as possible, as equal as possible.
void row_in_groups(const FewShifts* few_shifts, const TurnedMap& turned, Part part,
                   const std::int16_t* long_term, int count, MatchSum* sums) {
  for (int groups = (count + kMostShifts - 1) / kMostShifts; groups > 0; --groups) {
    const int shifts = (count + groups - 1) / groups;
    few_shifts[shifts - 1](turned, part, long_term, sums);
    long_term += shifts;
    sums += shifts;
    count -= shifts;
  }
}

/// Part by part, so that what it meets in the long-term map stays in the nearest cache.
void square_in_parts(const FewShifts* few_shifts, int part_blocks, const TurnedMap& turned,
                     const std::int16_t* long_term, int width, int side, MatchSum* sums) {
  MatchSum* const end = sums + std::ptrdiff_t{side} * side;
  std::fill(sums, end, MatchSum{});
  for (int begin = 0; begin < turned.blocks(); begin += part_blocks) {
    const Part part{begin, std::min(begin + part_blocks, turned.blocks())};
    for (int y = 0; y < side; ++y) {
      row_in_groups(few_shifts, turned, part, long_term + std::ptrdiff_t{y} * width, side,
                    sums + std::ptrdiff_t{y} * side);
    }
  }
  // Until here the unknown cells were counted in place of the others.
  for (MatchSum* sum = sums; sum != end; ++sum) {
    *sum = without_unknown(sum->difference_mm, sum->overlap, turned.cells());
  }
}

#define CAIRN_AVX2 __attribute__((target("avx2")))
#define CAIRN_AVX512 __attribute__((target("avx512f,avx512bw")))

struct Lanes256 {
  static constexpr int kBlocksUntilFull = 65535 / kTruncateMm / 2;
  __m256i difference, unknown;
};

CAIRN_AVX2 inline std::uint32_t sum_lanes(__m256i v) {
  const __m256i low = _mm256_and_si256(v, _mm256_set1_epi32(0xffff));
  const __m256i sums = _mm256_add_epi32(low, _mm256_srli_epi32(v, 16));
  __m128i s = _mm_add_epi32(_mm256_castsi256_si128(sums), _mm256_extracti128_si256(sums, 1));
  s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0x4e));
  s = _mm_add_epi32(s, _mm_shuffle_epi32(s, 0xb1));
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(s));
}

CAIRN_AVX2 inline __m256i load256(const std::int16_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
}

CAIRN_AVX2 inline void add(Lanes256& lanes, __m256i apart) {
  lanes.difference =
      _mm256_add_epi16(lanes.difference, _mm256_min_epi16(apart, _mm256_set1_epi16(kTruncateMm)));
  lanes.unknown = _mm256_sub_epi16(lanes.unknown,
                                   _mm256_cmpgt_epi16(apart, _mm256_set1_epi16(kOverlapLimitMm)));
}

template <int kShifts>
CAIRN_AVX2 void few_shifts256(const TurnedMap& turned, Part part, const std::int16_t* long_term,
                              MatchSum* sums) {
  Lanes256 lanes[kShifts];
#pragma GCC unroll 8
  for (Lanes256& l : lanes) l = {_mm256_setzero_si256(), _mm256_setzero_si256()};
  for (int b = part.begin; b < part.end; ++b) {
    const std::int16_t* cells = turned.height_mm.data() + std::ptrdiff_t{b} * kBlock;
    const std::int16_t* there = long_term + turned.at[static_cast<std::size_t>(b)];
    for (int half = 0; half < kBlock; half += 16) {
      const __m256i a = load256(cells + half);
#pragma GCC unroll 8
      for (int k = 0; k < kShifts; ++k) {
        add(lanes[k], _mm256_abs_epi16(_mm256_sub_epi16(a, load256(there + half + k))));
      }
    }
  }
#pragma GCC unroll 8
  for (int k = 0; k < kShifts; ++k) {
    sums[k].difference_mm += sum_lanes(lanes[k].difference);
    sums[k].overlap += sum_lanes(lanes[k].unknown);  // square_in_parts turns it round.
  }
}

constexpr FewShifts kFewShifts256[] = {few_shifts256<1>, few_shifts256<2>, few_shifts256<3>,
                                       few_shifts256<4>, few_shifts256<5>, few_shifts256<6>};

void square256(const TurnedMap& turned, const std::int16_t* long_term, int width, int side,
               MatchSum* sums) {
  square_in_parts(kFewShifts256, Lanes256::kBlocksUntilFull, turned, long_term, width, side, sums);
}

CAIRN_AVX2 MatchSum bound256(const TurnedMap& turned, const std::int16_t* lowest,
                             const std::int16_t* highest) {
  std::uint32_t difference = 0;
  std::uint32_t unknown = 0;
  const int blocks = turned.blocks();
  for (int begin = 0; begin < blocks; begin += Lanes256::kBlocksUntilFull) {
    const int end = std::min(begin + Lanes256::kBlocksUntilFull, blocks);
    Lanes256 lanes{_mm256_setzero_si256(), _mm256_setzero_si256()};
    for (int b = begin; b < end; ++b) {
      const std::int16_t* cells = turned.height_mm.data() + std::ptrdiff_t{b} * kBlock;
      const std::uint32_t at = turned.at[static_cast<std::size_t>(b)];
      for (int half = 0; half < kBlock; half += 16) {
        const __m256i a = load256(cells + half);
        const __m256i above = _mm256_sub_epi16(a, load256(highest + at + half));
        const __m256i below = _mm256_sub_epi16(load256(lowest + at + half), a);
        add(lanes, _mm256_max_epi16(_mm256_max_epi16(above, below), _mm256_setzero_si256()));
      }
    }
    difference += sum_lanes(lanes.difference);
    unknown += sum_lanes(lanes.unknown);
  }
  return without_unknown(difference, unknown, turned.cells());
}

struct Lanes512 {
  static constexpr int kBlocksUntilFull = 65535 / kTruncateMm;
  __m512i difference, unknown;
};

CAIRN_AVX512 inline std::uint32_t sum_lanes(__m512i v) {
  const __m512i low = _mm512_and_si512(v, _mm512_set1_epi32(0xffff));
  return static_cast<std::uint32_t>(
      _mm512_reduce_add_epi32(_mm512_add_epi32(low, _mm512_srli_epi32(v, 16))));
}

CAIRN_AVX512 inline void add(Lanes512& lanes, __m512i apart) {
  lanes.difference =
      _mm512_add_epi16(lanes.difference, _mm512_min_epi16(apart, _mm512_set1_epi16(kTruncateMm)));
  const __mmask32 is_unknown = _mm512_cmpgt_epi16_mask(apart, _mm512_set1_epi16(kOverlapLimitMm));
  lanes.unknown =
      _mm512_mask_add_epi16(lanes.unknown, is_unknown, lanes.unknown, _mm512_set1_epi16(1));
}

template <int kShifts>
CAIRN_AVX512 void few_shifts512(const TurnedMap& turned, Part part, const std::int16_t* long_term,
                                MatchSum* sums) {
  Lanes512 lanes[kShifts];
#pragma GCC unroll 8
  for (Lanes512& l : lanes) l = {_mm512_setzero_si512(), _mm512_setzero_si512()};
  for (int b = part.begin; b < part.end; ++b) {
    const __m512i a = _mm512_loadu_si512(turned.height_mm.data() + std::ptrdiff_t{b} * kBlock);
    const std::int16_t* there = long_term + turned.at[static_cast<std::size_t>(b)];
#pragma GCC unroll 8
    for (int k = 0; k < kShifts; ++k) {
      add(lanes[k], _mm512_abs_epi16(_mm512_sub_epi16(a, _mm512_loadu_si512(there + k))));
    }
  }
#pragma GCC unroll 8
  for (int k = 0; k < kShifts; ++k) {
    sums[k].difference_mm += sum_lanes(lanes[k].difference);
    sums[k].overlap += sum_lanes(lanes[k].unknown);  // square_in_parts turns it round.
  }
}

constexpr FewShifts kFewShifts512[] = {few_shifts512<1>, few_shifts512<2>, few_shifts512<3>,
                                       few_shifts512<4>, few_shifts512<5>, few_shifts512<6>};

void square512(const TurnedMap& turned, const std::int16_t* long_term, int width, int side,
               MatchSum* sums) {
  square_in_parts(kFewShifts512, Lanes512::kBlocksUntilFull, turned, long_term, width, side, sums);
}

CAIRN_AVX512 MatchSum bound512(const TurnedMap& turned, const std::int16_t* lowest,
                               const std::int16_t* highest) {
  std::uint32_t difference = 0;
  std::uint32_t unknown = 0;
  const int blocks = turned.blocks();
  for (int begin = 0; begin < blocks; begin += Lanes512::kBlocksUntilFull) {
    const int end = std::min(begin + Lanes512::kBlocksUntilFull, blocks);
    Lanes512 lanes{_mm512_setzero_si512(), _mm512_setzero_si512()};
    for (int b = begin; b < end; ++b) {
      const std::uint32_t at = turned.at[static_cast<std::size_t>(b)];
      const __m512i a = _mm512_loadu_si512(turned.height_mm.data() + std::ptrdiff_t{b} * kBlock);
      const __m512i above = _mm512_sub_epi16(a, _mm512_loadu_si512(highest + at));
      const __m512i below = _mm512_sub_epi16(_mm512_loadu_si512(lowest + at), a);
      add(lanes, _mm512_max_epi16(_mm512_max_epi16(above, below), _mm512_setzero_si512()));
    }
    difference += sum_lanes(lanes.difference);
    unknown += sum_lanes(lanes.unknown);
  }
  return without_unknown(difference, unknown, turned.cells());
}

}  // namespace

const MatchKernels* avx2_kernels() {
  static constexpr MatchKernels kKernels{"AVX2", square256, bound256};
  return __builtin_cpu_supports("avx2") ? &kKernels : nullptr;
}

const MatchKernels* avx512_kernels() {
  static constexpr MatchKernels kKernels{"AVX-512", square512, bound512};
  return __builtin_cpu_supports("avx512bw") ? &kKernels : nullptr;
}

}  // namespace cairn

#else

namespace cairn {

const MatchKernels* avx2_kernels() { return nullptr; }
const MatchKernels* avx512_kernels() { return nullptr; }

}  // namespace cairn

#endif
