// The sweeps with 256 and 512 bits. Costs are 32 bits; square roots are of 32-bit floats, which
// IEEE 754 rounds alike everywhere.
#include "core/planner/field_tile.h"
#include "core/planner/stencil.h"

#if defined(__x86_64__)
#include <immintrin.h>

#include <utility>

// GCC 12's own headers of AVX-512 begin some results from an undefined register on purpose.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"

namespace cairn {

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
namespace avx2_sweeps {
namespace {

struct Lanes {
  static constexpr int kWidth = 8;
  using V = __m256i;

  static V all(std::int32_t value) { return _mm256_set1_epi32(value); }
  static V load(const std::int32_t* p) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
  }
  /// All ones in the lanes that have their bit.
  static V lanes_of(std::uint32_t bits) {
    const V each = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    return _mm256_cmpeq_epi32(_mm256_and_si256(all(static_cast<std::int32_t>(bits)), each), each);
  }
  static V load_or_closed(const std::int32_t* p, std::uint32_t bits) {
    return _mm256_blendv_epi8(all(Field::kClosed), load(p), lanes_of(bits));
  }
  static void store(std::int32_t* p, V v, std::uint32_t bits) {
    _mm256_maskstore_epi32(p, lanes_of(bits), v);
  }
  static V add(V a, V b) { return _mm256_add_epi32(a, b); }
  static V sub(V a, V b) { return _mm256_sub_epi32(a, b); }
  static V min(V a, V b) { return _mm256_min_epi32(a, b); }
  static V max(V a, V b) { return _mm256_max_epi32(a, b); }
  static V abs(V a) { return _mm256_abs_epi32(a); }
  static std::uint32_t less(V a, V b) {
    return static_cast<std::uint32_t>(
        _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(b, a))));
  }
  static V widest_gap(V price) {
    return _mm256_srli_epi32(_mm256_mullo_epi32(price, all(kWidestGap16)), 16);
  }
  static V diagonal(V price) {
    const V product = _mm256_mullo_epi32(price, all(static_cast<std::int32_t>(kDiagonal16)));
    return _mm256_srli_epi32(_mm256_add_epi32(product, all(0x8000)), 16);
  }
  static V straight(V price, V gap) {
    const __m256 p = _mm256_cvtepi32_ps(price);
    const __m256 g = _mm256_cvtepi32_ps(gap);
    const __m256 root = _mm256_sqrt_ps(_mm256_mul_ps(_mm256_sub_ps(p, g), _mm256_add_ps(p, g)));
    return _mm256_cvttps_epi32(_mm256_add_ps(root, _mm256_set1_ps(0.5F)));
  }
  static void transpose(const std::int32_t* from, std::int32_t* to) {
    V a[8];
    V b[8];
    for (int i = 0; i < 8; ++i) a[i] = load(from + i * TilePlane::kStride);
    for (int i = 0; i < 8; i += 2) {
      b[i] = _mm256_unpacklo_epi32(a[i], a[i + 1]);
      b[i + 1] = _mm256_unpackhi_epi32(a[i], a[i + 1]);
    }
    for (int i = 0; i < 8; i += 4) {
      a[i] = _mm256_unpacklo_epi64(b[i], b[i + 2]);
      a[i + 1] = _mm256_unpackhi_epi64(b[i], b[i + 2]);
      a[i + 2] = _mm256_unpacklo_epi64(b[i + 1], b[i + 3]);
      a[i + 3] = _mm256_unpackhi_epi64(b[i + 1], b[i + 3]);
    }
    for (int i = 0; i < 4; ++i) {
      put(to + i * TilePlane::kStride, _mm256_permute2x128_si256(a[i], a[i + 4], 0x20));
      put(to + (i + 4) * TilePlane::kStride, _mm256_permute2x128_si256(a[i], a[i + 4], 0x31));
    }
  }
  static void put(std::int32_t* p, V v) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), v); }
};

#include "core/planner/field_sweeps.inc"

}  // namespace
}  // namespace avx2_sweeps
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
namespace avx512_sweeps {
namespace {

struct Lanes {
  static constexpr int kWidth = 16;
  using V = __m512i;

  static V all(std::int32_t value) { return _mm512_set1_epi32(value); }
  static V load(const std::int32_t* p) { return _mm512_loadu_si512(p); }
  static V load_or_closed(const std::int32_t* p, std::uint32_t bits) {
    return _mm512_mask_loadu_epi32(all(Field::kClosed), static_cast<__mmask16>(bits), p);
  }
  static void store(std::int32_t* p, V v, std::uint32_t bits) {
    _mm512_mask_storeu_epi32(p, static_cast<__mmask16>(bits), v);
  }
  static V add(V a, V b) { return _mm512_add_epi32(a, b); }
  static V sub(V a, V b) { return _mm512_sub_epi32(a, b); }
  static V min(V a, V b) { return _mm512_min_epi32(a, b); }
  static V max(V a, V b) { return _mm512_max_epi32(a, b); }
  static V abs(V a) { return _mm512_abs_epi32(a); }
  static std::uint32_t less(V a, V b) { return _mm512_cmplt_epi32_mask(a, b); }
  static V widest_gap(V price) {
    return _mm512_srli_epi32(_mm512_mullo_epi32(price, all(kWidestGap16)), 16);
  }
  static V diagonal(V price) {
    const V product = _mm512_mullo_epi32(price, all(static_cast<std::int32_t>(kDiagonal16)));
    return _mm512_srli_epi32(_mm512_add_epi32(product, all(0x8000)), 16);
  }
  static V straight(V price, V gap) {
    const __m512 p = _mm512_cvtepi32_ps(price);
    const __m512 g = _mm512_cvtepi32_ps(gap);
    const __m512 root = _mm512_sqrt_ps(_mm512_mul_ps(_mm512_sub_ps(p, g), _mm512_add_ps(p, g)));
    return _mm512_cvttps_epi32(_mm512_add_ps(root, _mm512_set1_ps(0.5F)));
  }
  static void transpose(const std::int32_t* from, std::int32_t* to) {
    V a[16];
    V b[16];
    for (int i = 0; i < 16; ++i) a[i] = load(from + i * TilePlane::kStride);
    for (int i = 0; i < 16; i += 2) {
      b[i] = _mm512_unpacklo_epi32(a[i], a[i + 1]);
      b[i + 1] = _mm512_unpackhi_epi32(a[i], a[i + 1]);
    }
    for (int i = 0; i < 16; i += 4) {
      a[i] = _mm512_unpacklo_epi64(b[i], b[i + 2]);
      a[i + 1] = _mm512_unpackhi_epi64(b[i], b[i + 2]);
      a[i + 2] = _mm512_unpacklo_epi64(b[i + 1], b[i + 3]);
      a[i + 3] = _mm512_unpackhi_epi64(b[i + 1], b[i + 3]);
    }
    for (int i = 0; i < 4; ++i) {
      // Quarters of four rows each; their columns are i, i + 4, i + 8 and i + 12.
      const V even_low = _mm512_shuffle_i32x4(a[i], a[i + 4], 0x88);
      const V even_high = _mm512_shuffle_i32x4(a[i + 8], a[i + 12], 0x88);
      const V odd_low = _mm512_shuffle_i32x4(a[i], a[i + 4], 0xdd);
      const V odd_high = _mm512_shuffle_i32x4(a[i + 8], a[i + 12], 0xdd);
      put(to + i * TilePlane::kStride, _mm512_shuffle_i32x4(even_low, even_high, 0x88));
      put(to + (i + 4) * TilePlane::kStride, _mm512_shuffle_i32x4(odd_low, odd_high, 0x88));
      put(to + (i + 8) * TilePlane::kStride, _mm512_shuffle_i32x4(even_low, even_high, 0xdd));
      put(to + (i + 12) * TilePlane::kStride, _mm512_shuffle_i32x4(odd_low, odd_high, 0xdd));
    }
  }
  static void put(std::int32_t* p, V v) { _mm512_storeu_si512(p, v); }
};

#include "core/planner/field_sweeps.inc"

}  // namespace
}  // namespace avx512_sweeps
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

const FieldKernels* avx2_field_kernels() {
  static constexpr FieldKernels kKernels{"AVX2", avx2_sweeps::solve};
  return __builtin_cpu_supports("avx2") ? &kKernels : nullptr;
}

const FieldKernels* avx512_field_kernels() {
  static constexpr FieldKernels kKernels{"AVX-512", avx512_sweeps::solve};
  const bool all = __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512vl");
  return all ? &kKernels : nullptr;
}

}  // namespace cairn

#else

namespace cairn {

const FieldKernels* avx2_field_kernels() { return nullptr; }
const FieldKernels* avx512_field_kernels() { return nullptr; }

}  // namespace cairn

#endif
