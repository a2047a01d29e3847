#pragma once

#include <array>
#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "core/map/cell.h"

namespace cairn {

/// Which tile of a map: level (stacked 2½-D maps, T5.2; 0 = ground) and tile coordinates, each
/// tile being 64 × 64 cells.
struct TileKey {
  std::int8_t level = 0;
  std::int32_t tx = 0;
  std::int32_t ty = 0;
  friend auto operator<=>(const TileKey&, const TileKey&) = default;
};

struct TileKeyHash {
  std::size_t operator()(const TileKey& key) const;
};

/// 64 × 64 cells of one level, dense. Heights are int16 millimetres around the tile's datum, so a
/// tile spans ±32.7 m and a site any height.
class Tile {
 public:
  static constexpr int kSize = 64;
  static constexpr int kCells = kSize * kSize;
  static constexpr int kHeightLimitMm = 32767;

  explicit Tile(std::int32_t datum_mm) : datum_mm_(datum_mm) {
    height_mm_.fill(0);
    probability_.fill(0);
  }

  /// Index of the cell at (x, y) within the tile, row by row from the south-west corner.
  /// Requires: 0 ≤ x, y < 64.
  [[nodiscard]] static constexpr int index(int x, int y) { return y * kSize + x; }

  [[nodiscard]] std::int32_t datum_mm() const { return datum_mm_; }
  [[nodiscard]] bool known(int i) const { return probability_[at(i)] != 0; }
  [[nodiscard]] std::uint8_t probability(int i) const { return probability_[at(i)]; }
  [[nodiscard]] std::int32_t height_mm(int i) const { return datum_mm_ + height_mm_[at(i)]; }
  [[nodiscard]] Cell cell(int i) const { return {height_mm(i), probability(i)}; }

  /// Whether a height fits around this tile's datum.
  [[nodiscard]] bool representable(std::int32_t height_mm) const {
    const std::int64_t offset = std::int64_t{height_mm} - datum_mm_;
    return offset >= -kHeightLimitMm && offset <= kHeightLimitMm;
  }
  /// Requires: representable(cell.height_mm) or the cell is unknown. An unknown cell is stored as
  /// height 0 at the datum, so that equal maps are equal bytes.
  void set(int i, const Cell& cell) {
    assert(!cell.known() || representable(cell.height_mm));
    height_mm_[at(i)] =
        cell.known() ? static_cast<std::int16_t>(cell.height_mm - datum_mm_) : std::int16_t{0};
    probability_[at(i)] = cell.probability;
  }

  [[nodiscard]] int known_count() const;
  friend bool operator==(const Tile&, const Tile&) = default;

 private:
  static constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

  std::int32_t datum_mm_;
  std::array<std::int16_t, kCells> height_mm_;
  std::array<std::uint8_t, kCells> probability_;
};

}  // namespace cairn
