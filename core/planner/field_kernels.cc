#include <cmath>
#include <cstdlib>
#include <utility>

#include "core/planner/field_tile.h"
#include "core/planner/stencil.h"

namespace cairn {
namespace portable_sweeps {
namespace {

/// Plain C++, eight cells at a time.
struct Lanes {
  static constexpr int kWidth = 8;
  struct V {
    std::int32_t lane[kWidth];
  };

  template <class Make>
  static V each(const Make& make) {
    V v;
    for (int i = 0; i < kWidth; ++i) v.lane[i] = make(i);
    return v;
  }
  static V all(std::int32_t value) {
    return each([=](int) { return value; });
  }
  static V load(const std::int32_t* p) {
    return each([=](int i) { return p[i]; });
  }
  static V load_or_closed(const std::int32_t* p, std::uint32_t bits) {
    return each([=](int i) { return (bits >> i & 1) != 0 ? p[i] : Field::kClosed; });
  }
  static void store(std::int32_t* p, const V& v, std::uint32_t bits) {
    for (int i = 0; i < kWidth; ++i) p[i] = (bits >> i & 1) != 0 ? v.lane[i] : p[i];
  }
  static V add(const V& a, const V& b) {
    return each([&](int i) { return a.lane[i] + b.lane[i]; });
  }
  static V sub(const V& a, const V& b) {
    return each([&](int i) { return a.lane[i] - b.lane[i]; });
  }
  static V min(const V& a, const V& b) {
    return each([&](int i) { return std::min(a.lane[i], b.lane[i]); });
  }
  static V max(const V& a, const V& b) {
    return each([&](int i) { return std::max(a.lane[i], b.lane[i]); });
  }
  static V abs(const V& a) {
    return each([&](int i) { return std::abs(a.lane[i]); });
  }
  static std::uint32_t less(const V& a, const V& b) {
    std::uint32_t bits = 0;
    for (int i = 0; i < kWidth; ++i) bits |= std::uint32_t{a.lane[i] < b.lane[i]} << i;
    return bits;
  }
  static V widest_gap(const V& price) {
    return each([&](int i) { return cairn::widest_gap(price.lane[i]); });
  }
  static V diagonal(const V& price) {
    return each([&](int i) { return diagonal_units(price.lane[i]); });
  }
  static V straight(const V& price, const V& gap) {
    return each([&](int i) { return straight_units(price.lane[i], gap.lane[i]); });
  }
  static void transpose(const std::int32_t* from, std::int32_t* to) {
    for (int y = 0; y < kWidth; ++y) {
      for (int x = 0; x < kWidth; ++x)
        to[x * TilePlane::kStride + y] = from[y * TilePlane::kStride + x];
    }
  }
};

#include "core/planner/field_sweeps.inc"

}  // namespace
}  // namespace portable_sweeps

void transpose_bits(std::array<RowBits, 64>& square) {
  // Ever smaller blocks change places across the diagonal (Warren, Hacker's Delight, 7-3).
  RowBits low = 0x00000000FFFFFFFFULL;
  for (unsigned size = 32; size != 0; size /= 2, low ^= low << size) {
    for (unsigned row = 0; row < 64; row = (row + size + 1) & ~size) {
      const RowBits swapped = (square[row] >> size ^ square[row + size]) & low;
      square[row] ^= swapped << size;
      square[row + size] ^= swapped;
    }
  }
}

const FieldKernels& portable_field_kernels() {
  static constexpr FieldKernels kKernels{"portable", portable_sweeps::solve};
  return kKernels;
}

const std::vector<const FieldKernels*>& usable_field_kernels() {
  static const std::vector<const FieldKernels*> all = [] {
    std::vector<const FieldKernels*> usable{avx512_field_kernels(), avx2_field_kernels(),
                                            &portable_field_kernels()};
    std::erase(usable, nullptr);
    return usable;
  }();
  return all;
}

}  // namespace cairn
