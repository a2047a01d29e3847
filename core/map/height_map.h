#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>

#include "core/map/cell.h"
#include "core/map/tile.h"

namespace cairn {

/// A sparse, unbounded 2½-D map: dense tiles made where something was seen.
/// Not thread-safe. Copying copies all tiles.
class HeightMap {
 public:
  /// Requires: cell_size_mm > 0.
  explicit HeightMap(int cell_size_mm) : cell_size_mm_(cell_size_mm) {}

  [[nodiscard]] int cell_size_mm() const { return cell_size_mm_; }
  [[nodiscard]] double cell_size_m() const { return cell_size_mm_ / 1000.0; }

  /// The cell that holds the point (x, y) [m]. Requires: |x|, |y| < kMaxExtentM.
  [[nodiscard]] CellIndex cell_at(double x_m, double y_m) const {
    return {static_cast<std::int32_t>(std::floor(x_m / cell_size_m())),
            static_cast<std::int32_t>(std::floor(y_m / cell_size_m()))};
  }
  /// The middle of a cell [m].
  [[nodiscard]] double centre_m(std::int32_t index) const { return (index + 0.5) * cell_size_m(); }

  [[nodiscard]] static TileKey tile_of(CellIndex cell, std::int8_t level = 0) {
    return {level, cell.x >> 6, cell.y >> 6};
  }
  [[nodiscard]] static int index_in_tile(CellIndex cell) {
    return Tile::index(cell.x & 63, cell.y & 63);
  }

  [[nodiscard]] const Tile* find(const TileKey& key) const;
  [[nodiscard]] Tile* find(const TileKey& key);
  /// The tile, made on first use with the datum `height_mm` rounded to a whole metre.
  /// Requires: storable(height_mm).
  Tile& make(const TileKey& key, std::int32_t height_mm);
  void insert(const TileKey& key, const Tile& tile);
  void erase(const TileKey& key) { tiles_.erase(key); }

  /// Cell{} where nothing is known.
  [[nodiscard]] Cell cell(CellIndex index, std::int8_t level = 0) const;
  /// Sets a cell, making the tile if needed. Returns false, changing nothing, when the height is
  /// not representable around the tile's datum or not storable at all.
  bool set(CellIndex index, const Cell& cell, std::int8_t level = 0);

  using Tiles = std::unordered_map<TileKey, std::unique_ptr<Tile>, TileKeyHash>;
  [[nodiscard]] const Tiles& tiles() const { return tiles_; }
  [[nodiscard]] std::size_t known_count() const;

  HeightMap(HeightMap&&) = default;
  HeightMap& operator=(HeightMap&&) = default;
  HeightMap(const HeightMap& other);
  HeightMap& operator=(const HeightMap& other);

  /// [m] Coordinates beyond this from the origin are refused everywhere in Cairn.
  static constexpr double kMaxExtentM = 100'000.0;
  /// Whether a height lies within kMaxExtentM of the origin.
  [[nodiscard]] static constexpr bool storable(std::int32_t height_mm) {
    return height_mm >= -kMaxHeightMm && height_mm <= kMaxHeightMm;
  }

 private:
  static constexpr std::int32_t kMaxHeightMm = 100'000'000;

  int cell_size_mm_;
  Tiles tiles_;
};

}  // namespace cairn
