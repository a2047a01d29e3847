// Judging terrain with 256 and 512 bits, 16 a cell: heights of a block around a level of its own.
#include "core/map/terrain_kernels.h"

#if defined(__x86_64__)
#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <memory>

// GCC 12's own headers of AVX-512 begin some results from an undefined register on purpose.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"

namespace cairn {
namespace {

/// [mm] Heights of a block lie within this of its level, so that differences fit 16 bits, and those
/// from what is unknown are beyond every limit.
constexpr std::int32_t kSpanMm = 16000;
constexpr std::int16_t kUnknown = std::numeric_limits<std::int16_t>::max();
static_assert(kUnknown - kSpanMm > TerrainRules::kHighest16BitLimitMm);

/// The level that a block's heights are told from, and whether they all are near it.
struct BlockLevel {
  const HeightGrid& grid;
  std::int32_t& level_mm;
  std::int32_t lowest_mm = std::numeric_limits<std::int32_t>::max();
  std::int32_t highest_mm = std::numeric_limits<std::int32_t>::min();

  void note(std::int32_t lowest, std::int32_t highest) {
    lowest_mm = std::min(lowest_mm, lowest);
    highest_mm = std::max(highest_mm, highest);
  }
  [[nodiscard]] bool fit() const {
    return lowest_mm > highest_mm || (std::int64_t{lowest_mm} - level_mm >= -kSpanMm &&
                                      std::int64_t{highest_mm} - level_mm <= kSpanMm);
  }
  /// To the middle of the heights. False when they are too far apart for any.
  bool move() {
    const std::int64_t middle = (std::int64_t{lowest_mm} + highest_mm) / 2;
    level_mm = static_cast<std::int32_t>(middle);
    return fit();
  }
  /// One cell that no vector holds.
  std::int16_t told(std::int32_t height_mm, std::uint8_t probability) {
    if (probability == 0) return kUnknown;
    note(height_mm, height_mm);
    return static_cast<std::int16_t>(static_cast<std::uint32_t>(height_mm) -
                                     static_cast<std::uint32_t>(level_mm));
  }
};

}  // namespace

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
namespace avx2_terrain {
namespace {

struct Lanes {
  static constexpr int kWidth = 16;
  using Height = std::int16_t;
  static constexpr Height kNone = kUnknown;
  using V = __m256i;
  using Mask = __m256i;

  struct Reader : BlockLevel {
    Reader(const HeightGrid& grid_read, std::int32_t& level) : BlockLevel{grid_read, level} {}

    void read(std::size_t at, int cells, Height* to) {
      const std::int32_t* height = grid.height_mm.data() + at;
      const std::uint8_t* probability = grid.probability.data() + at;
      const __m256i level = _mm256_set1_epi32(level_mm);
      __m256i low = _mm256_set1_epi32(lowest_mm);
      __m256i high = _mm256_set1_epi32(highest_mm);
      int x = 0;
      for (; x + 8 <= cells; x += 8) {
        const __m256i h = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(height + x));
        const __m256i p = _mm256_cvtepu8_epi32(
            _mm_loadl_epi64(reinterpret_cast<const __m128i*>(probability + x)));
        const __m256i none = _mm256_cmpeq_epi32(p, _mm256_setzero_si256());
        low = _mm256_min_epi32(low, _mm256_blendv_epi8(h, low, none));
        high = _mm256_max_epi32(high, _mm256_blendv_epi8(h, high, none));
        const __m256i told =
            _mm256_blendv_epi8(_mm256_sub_epi32(h, level), _mm256_set1_epi32(kUnknown), none);
        const __m256i packed = _mm256_packs_epi32(told, told);
        _mm_storeu_si128(
            reinterpret_cast<__m128i*>(to + x),
            _mm256_castsi256_si128(_mm256_permute4x64_epi64(packed, _MM_SHUFFLE(3, 1, 2, 0))));
      }
      std::int32_t lows[8];
      std::int32_t highs[8];
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(lows), low);
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(highs), high);
      note(*std::min_element(lows, lows + 8), *std::max_element(highs, highs + 8));
      for (; x < cells; ++x) to[x] = told(height[x], probability[x]);
    }
  };

  static V all(std::int32_t value) { return _mm256_set1_epi16(static_cast<std::int16_t>(value)); }
  static V load(const Height* p) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)); }
  static void store(Height* p, V v) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), v); }
  static V load_bytes(const std::uint8_t* p) {
    return _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
  }
  static void store_bytes(std::uint8_t* p, V v) {
    const __m256i packed = _mm256_permute4x64_epi64(_mm256_packus_epi16(v, v), 0x08);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(p), _mm256_castsi256_si128(packed));
  }
  static V add(V a, V b) { return _mm256_adds_epi16(a, b); }
  static V fall(V a, V b) { return sub(a, b); }
  static V sub(V a, V b) { return _mm256_subs_epi16(a, b); }
  static V min(V a, V b) { return _mm256_min_epi16(a, b); }
  static V max(V a, V b) { return _mm256_max_epi16(a, b); }
  static V abs(V a) { return _mm256_abs_epi16(_mm256_max_epi16(a, all(-32767))); }
  static V quarter(V a) { return _mm256_srai_epi16(a, 2); }
  static V shift(V a, int by) { return _mm256_sll_epi16(a, _mm_cvtsi32_si128(by)); }
  static V scaled(V a, V b) { return _mm256_mulhrs_epi16(a, b); }
  static Mask greater(V a, V b) { return _mm256_cmpgt_epi16(a, b); }
  static Mask equal(V a, V b) { return _mm256_cmpeq_epi16(a, b); }
  static Mask nowhere() { return _mm256_setzero_si256(); }
  static Mask either(Mask a, Mask b) { return _mm256_or_si256(a, b); }
  static Mask both(Mask a, Mask b) { return _mm256_and_si256(a, b); }
  static Mask but_not(Mask a, Mask b) { return _mm256_andnot_si256(b, a); }
  static bool any(Mask a) { return _mm256_testz_si256(a, a) == 0; }
  static std::uint32_t bits(Mask a) {
    const __m256i packed = _mm256_permute4x64_epi64(_mm256_packs_epi16(a, a), 0x08);
    return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm256_castsi256_si128(packed)));
  }
  static V select(Mask where, V there, V elsewhere) {
    return _mm256_blendv_epi8(elsewhere, there, where);
  }
  static void prefetch(const void* p) { _mm_prefetch(static_cast<const char*>(p), _MM_HINT_T0); }
  static V unless(Mask where, V v) { return _mm256_andnot_si256(where, v); }
  /// Past the caches, but for what does not fill a vector.
  static void stream(std::uint8_t* to, const std::uint8_t* from, std::size_t bytes) {
    std::size_t i = std::min(bytes, -reinterpret_cast<std::uintptr_t>(to) % 32);
    std::memcpy(to, from, i);
    for (; i + 32 <= bytes; i += 32) {
      _mm256_stream_si256(reinterpret_cast<__m256i*>(to + i),
                          _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from + i)));
    }
    std::memcpy(to + i, from + i, bytes - i);
  }
  static void end_stream() { _mm_sfence(); }
};

#include "core/map/terrain_rows.inc"

}  // namespace
}  // namespace avx2_terrain
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl"))), \
                             apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl")
#endif
namespace avx512_terrain {
namespace {

struct Lanes {
  static constexpr int kWidth = 32;
  using Height = std::int16_t;
  static constexpr Height kNone = kUnknown;
  using V = __m512i;
  using Mask = __mmask32;

  struct Reader : BlockLevel {
    Reader(const HeightGrid& grid_read, std::int32_t& level) : BlockLevel{grid_read, level} {}

    void read(std::size_t at, int cells, Height* to) {
      const std::int32_t* height = grid.height_mm.data() + at;
      const std::uint8_t* probability = grid.probability.data() + at;
      const __m512i level = _mm512_set1_epi32(level_mm);
      __m512i low = _mm512_set1_epi32(lowest_mm);
      __m512i high = _mm512_set1_epi32(highest_mm);
      int x = 0;
      for (; x + 16 <= cells; x += 16) {
        const __m512i h = _mm512_loadu_si512(height + x);
        const __m128i p = _mm_loadu_si128(reinterpret_cast<const __m128i*>(probability + x));
        const __mmask16 known = _mm_test_epi8_mask(p, p);
        low = _mm512_mask_min_epi32(low, known, low, h);
        high = _mm512_mask_max_epi32(high, known, high, h);
        const __m256i told = _mm512_cvtepi32_epi16(_mm512_sub_epi32(h, level));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + x),
                            _mm256_mask_mov_epi16(_mm256_set1_epi16(kUnknown), known, told));
      }
      note(_mm512_reduce_min_epi32(low), _mm512_reduce_max_epi32(high));
      for (; x < cells; ++x) to[x] = told(height[x], probability[x]);
    }
  };

  static V all(std::int32_t value) { return _mm512_set1_epi16(static_cast<std::int16_t>(value)); }
  static V load(const Height* p) { return _mm512_loadu_si512(p); }
  static void store(Height* p, V v) { _mm512_storeu_si512(p, v); }
  static V load_bytes(const std::uint8_t* p) {
    return _mm512_cvtepu8_epi16(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)));
  }
  static void store_bytes(std::uint8_t* p, V v) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), _mm512_cvtepi16_epi8(v));
  }
  static V add(V a, V b) { return _mm512_adds_epi16(a, b); }
  static V fall(V a, V b) { return sub(a, b); }
  static V sub(V a, V b) { return _mm512_subs_epi16(a, b); }
  static V min(V a, V b) { return _mm512_min_epi16(a, b); }
  static V max(V a, V b) { return _mm512_max_epi16(a, b); }
  static V abs(V a) { return _mm512_abs_epi16(_mm512_max_epi16(a, all(-32767))); }
  static V quarter(V a) { return _mm512_srai_epi16(a, 2); }
  static V shift(V a, int by) { return _mm512_sll_epi16(a, _mm_cvtsi32_si128(by)); }
  static V scaled(V a, V b) { return _mm512_mulhrs_epi16(a, b); }
  static Mask greater(V a, V b) { return _mm512_cmpgt_epi16_mask(a, b); }
  static Mask equal(V a, V b) { return _mm512_cmpeq_epi16_mask(a, b); }
  static Mask nowhere() { return 0; }
  static Mask either(Mask a, Mask b) { return a | b; }
  static Mask both(Mask a, Mask b) { return a & b; }
  static Mask but_not(Mask a, Mask b) { return a & ~b; }
  static bool any(Mask a) { return a != 0; }
  static std::uint32_t bits(Mask a) { return a; }
  static V select(Mask where, V there, V elsewhere) {
    return _mm512_mask_mov_epi16(elsewhere, where, there);
  }
  static void prefetch(const void* p) { _mm_prefetch(static_cast<const char*>(p), _MM_HINT_T0); }
  static V unless(Mask where, V v) { return _mm512_maskz_mov_epi16(~where, v); }
  /// Past the caches, but for what does not fill a vector.
  static void stream(std::uint8_t* to, const std::uint8_t* from, std::size_t bytes) {
    std::size_t i = std::min(bytes, -reinterpret_cast<std::uintptr_t>(to) % 64);
    std::memcpy(to, from, i);
    for (; i + 64 <= bytes; i += 64) {
      _mm512_stream_si512(reinterpret_cast<__m512i*>(to + i), _mm512_loadu_si512(from + i));
    }
    std::memcpy(to + i, from + i, bytes - i);
  }
  static void end_stream() { _mm_sfence(); }
};

#include "core/map/terrain_rows.inc"

}  // namespace
}  // namespace avx512_terrain
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

const TerrainKernels* avx2_terrain_kernels() {
  static constexpr TerrainKernels kKernels{"AVX2", avx2_terrain::judge};
  return __builtin_cpu_supports("avx2") ? &kKernels : nullptr;
}

const TerrainKernels* avx512_terrain_kernels() {
  static constexpr TerrainKernels kKernels{"AVX-512", avx512_terrain::judge};
  const bool all = __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512vl");
  return all ? &kKernels : nullptr;
}

}  // namespace cairn

#else

namespace cairn {

const TerrainKernels* avx2_terrain_kernels() { return nullptr; }
const TerrainKernels* avx512_terrain_kernels() { return nullptr; }

}  // namespace cairn

#endif
