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

/// Four cells at a time by the compiler's own vectors, which every processor has, in 32 bits:
/// heights as they are. What the others work out in 16 bits is cut off as theirs.
struct Lanes {
  static constexpr int kWidth = 4;
  using Height = std::int32_t;
  /// [mm] Beyond what is stored. What is unknown is higher than that by more than any limit.
  static constexpr Height kHighest = (1 << 29) - 1;
  static constexpr Height kNone = 1 << 30;
  static_assert(kNone - kHighest > TerrainRules::kHighestLimitMm);
  using V [[gnu::vector_size(16)]] = std::int32_t;
  using Mask = V;  ///< All ones in a lane, or 0.

  class Reader {
   public:
    Reader(const HeightGrid& grid, std::int32_t& /*level_mm*/) : grid_(grid) {}

    void read(std::size_t at, int cells, Height* to) {
      for (int x = 0; x < cells; ++x, ++at) {
        const std::int32_t height_mm = std::clamp(grid_.height_mm[at], -kHighest, kHighest);
        to[x] = grid_.probability[at] != 0 ? height_mm : kNone;
      }
    }
    [[nodiscard]] static bool fit() { return true; }
    [[nodiscard]] static bool move() { return false; }

   private:
    const HeightGrid& grid_;
  };

  static V all(std::int32_t value) { return V{value, value, value, value}; }
  static V load(const Height* p) {
    V v;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  static void store(Height* p, V v) { std::memcpy(p, &v, sizeof v); }
  static V load_bytes(const std::uint8_t* p) { return V{p[0], p[1], p[2], p[3]}; }
  static void store_bytes(std::uint8_t* p, V v) {
    for (int i = 0; i < kWidth; ++i) p[i] = static_cast<std::uint8_t>(v[i]);
  }
  static V cut(V a) { return min(max(a, all(-32768)), all(32767)); }
  static V add(V a, V b) { return cut(a + b); }
  static V fall(V a, V b) { return a - b; }
  static V sub(V a, V b) { return cut(a - b); }
  static V min(V a, V b) { return select(greater(b, a), a, b); }
  static V max(V a, V b) { return select(greater(a, b), a, b); }
  static V abs(V a) { return min(max(a, -a), all(32767)); }
  static V quarter(V a) { return a >> 2; }
  static V shift(V a, int by) { return a * all(1 << by); }
  /// a · b · 2^-15, rounded.
  static V scaled(V a, V b) { return (a * b + all(0x4000)) >> 15; }
  static Mask greater(V a, V b) { return a > b; }
  static Mask equal(V a, V b) { return a == b; }
  static Mask nowhere() { return all(0); }
  static Mask either(Mask a, Mask b) { return a | b; }
  static Mask both(Mask a, Mask b) { return a & b; }
  static Mask but_not(Mask a, Mask b) { return a & ~b; }
  static bool any(Mask a) { return bits(a) != 0; }
  static std::uint32_t bits(Mask a) {
    const V bit_of_each = a & V{1, 2, 4, 8};
    return static_cast<std::uint32_t>(bit_of_each[0] | bit_of_each[1] | bit_of_each[2] |
                                      bit_of_each[3]);
  }
  static V select(Mask where, V there, V elsewhere) {
    return (there & where) | (elsewhere & ~where);
  }
  static V unless(Mask where, V v) { return v & ~where; }
  static void prefetch(const void* p) { __builtin_prefetch(p); }
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
