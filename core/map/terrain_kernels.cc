#include "core/map/terrain_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>

namespace cairn {
namespace portable_terrain {
namespace {

/// Plain C++, eight cells at a time, in 32 bits: heights as they are. What the others work out in
/// 16 bits is cut off as theirs.
struct Lanes {
  static constexpr int kWidth = 8;
  using Height = std::int32_t;
  static constexpr Height kNone = 1 << 30;  ///< A difference from it is 32 bits, too.
  struct V {
    std::int32_t lane[kWidth];
  };
  using Mask = V;  ///< All ones in a lane, or 0.

  class Reader {
   public:
    Reader(const HeightGrid& grid, std::int32_t& /*level_mm*/) : grid_(grid) {}

    void read(std::size_t at, int cells, Height* to) {
      for (int x = 0; x < cells; ++x, ++at) {
        const std::int32_t height_mm = std::clamp(grid_.height_mm[at], 1 - kNone, kNone - 1);
        to[x] = grid_.probability[at] != 0 ? height_mm : kNone;
      }
    }
    [[nodiscard]] static bool fit() { return true; }
    [[nodiscard]] static bool move() { return false; }

   private:
    const HeightGrid& grid_;
  };

  template <class Make>
  static V each(const Make& make) {
    V v;
    for (int i = 0; i < kWidth; ++i) v.lane[i] = make(i);
    return v;
  }
  static std::int32_t cut(std::int32_t value) { return std::min(std::max(value, -32768), 32767); }
  static V all(std::int32_t value) {
    return each([=](int) { return value; });
  }
  static V load(const Height* p) {
    return each([=](int i) { return p[i]; });
  }
  static void store(Height* p, const V& v) { std::copy_n(v.lane, kWidth, p); }
  static V load_bytes(const std::uint8_t* p) {
    return each([=](int i) { return p[i]; });
  }
  static void store_bytes(std::uint8_t* p, const V& v) {
    for (int i = 0; i < kWidth; ++i) p[i] = static_cast<std::uint8_t>(v.lane[i]);
  }
  static V add(const V& a, const V& b) {
    return each([&](int i) { return cut(a.lane[i] + b.lane[i]); });
  }
  static V sub(const V& a, const V& b) {
    return each([&](int i) { return cut(a.lane[i] - b.lane[i]); });
  }
  static V min(const V& a, const V& b) {
    return each([&](int i) { return std::min(a.lane[i], b.lane[i]); });
  }
  static V max(const V& a, const V& b) {
    return each([&](int i) { return std::max(a.lane[i], b.lane[i]); });
  }
  static V abs(const V& a) {
    return each([&](int i) { return std::min(std::abs(a.lane[i]), 32767); });
  }
  static V quarter(const V& a) {
    return each([&](int i) { return a.lane[i] >> 2; });
  }
  static V shift(const V& a, int by) {
    return each([&](int i) { return a.lane[i] * (1 << by); });
  }
  /// a · b · 2^-15, rounded.
  static V scaled(const V& a, const V& b) {
    return each([&](int i) { return (a.lane[i] * b.lane[i] + 0x4000) >> 15; });
  }
  static Mask greater(const V& a, const V& b) {
    return each([&](int i) { return a.lane[i] > b.lane[i] ? -1 : 0; });
  }
  static Mask equal(const V& a, const V& b) {
    return each([&](int i) { return a.lane[i] == b.lane[i] ? -1 : 0; });
  }
  static Mask both(const Mask& a, const Mask& b) {
    return each([&](int i) { return a.lane[i] & b.lane[i]; });
  }
  static Mask but_not(const Mask& a, const Mask& b) {
    return each([&](int i) { return a.lane[i] & ~b.lane[i]; });
  }
  static bool any(const Mask& a) {
    std::int32_t all_of = 0;
    for (const std::int32_t lane : a.lane) all_of |= lane;
    return all_of != 0;
  }
  static std::uint32_t bits(const Mask& a) {
    std::uint32_t bits = 0;
    for (int i = 0; i < kWidth; ++i) bits |= static_cast<std::uint32_t>(a.lane[i] & 1) << i;
    return bits;
  }
  static V select(const Mask& where, const V& there, const V& elsewhere) {
    return each([&](int i) {
      return (there.lane[i] & where.lane[i]) | (elsewhere.lane[i] & ~where.lane[i]);
    });
  }
  static void prefetch(const void*) {}
  static V unless(const Mask& where, const V& v) { return but_not(v, where); }
  static void stream(std::uint8_t* to, const std::uint8_t* from, std::size_t bytes) {
    std::memcpy(to, from, bytes);
  }
  static void end_stream() {}
};

#include "core/map/terrain_rows.inc"

}  // namespace
}  // namespace portable_terrain

const TerrainKernels& portable_terrain_kernels() {
  static constexpr TerrainKernels kKernels{"portable", portable_terrain::judge};
  return kKernels;
}

const std::vector<const TerrainKernels*>& usable_terrain_kernels() {
  static const std::vector<const TerrainKernels*> all = [] {
    std::vector<const TerrainKernels*> usable{avx512_terrain_kernels(), avx2_terrain_kernels(),
                                              &portable_terrain_kernels()};
    std::erase(usable, nullptr);
    return usable;
  }();
  return all;
}

}  // namespace cairn
