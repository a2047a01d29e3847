#include "core/map/fold.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/map/fold_rules.h"

namespace cairn {
namespace {

/// Lengths are in half millimetres (the middle of a cell of odd size needs them); products with a
/// sine or cosine in kUnit parts of that. Whole numbers make a fold the same on every machine, and
/// a submap that is shifted by whole cells and not turned folds exactly.
constexpr std::int64_t kHalfMm = 2;
constexpr std::int64_t kUnit = std::int64_t{1} << 30;
/// [half mm] Tiles that begin beyond this, in the site or the submap, are left out.
constexpr auto kMaxExtent = static_cast<std::int64_t>(HeightMap::kMaxExtentM) * 1000 * kHalfMm;

struct Point {
  std::int64_t x = 0;
  std::int64_t y = 0;
};

/// Requires: b > 0.
std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a / b - static_cast<std::int64_t>(a % b < 0);
}

struct Range {
  std::int64_t first;
  std::int64_t last;
};

/// The submap's pose, ready to carry cells over.
class Placement {
 public:
  explicit Placement(const Submap& submap)
      : at_{submap.T_site_submap.x_mm * kHalfMm, submap.T_site_submap.y_mm * kHalfMm},
        cell_(submap.surface.cell_size_mm() * kHalfMm),
        cos_(std::llround(std::cos(submap.T_site_submap.yaw_1e4rad * 1e-4) * kUnit)),
        sin_(std::llround(std::sin(submap.T_site_submap.yaw_1e4rad * 1e-4) * kUnit)) {}

  /// The submap's cell under the middle of a cell of the site.
  [[nodiscard]] CellIndex submap_cell(CellIndex site_cell) const {
    const std::int64_t x = middle(site_cell.x) - at_.x;
    const std::int64_t y = middle(site_cell.y) - at_.y;
    return {static_cast<std::int32_t>(floor_div(cos_ * x + sin_ * y, cell_ * kUnit)),
            static_cast<std::int32_t>(floor_div(cos_ * y - sin_ * x, cell_ * kUnit))};
  }
  /// [half mm] A corner of a submap's tile in the site.
  [[nodiscard]] Point site_point(std::int64_t tx, std::int64_t ty) const {
    const std::int64_t x = tx * tile_size();
    const std::int64_t y = ty * tile_size();
    return {at_.x + floor_div(cos_ * x - sin_ * y, kUnit),
            at_.y + floor_div(sin_ * x + cos_ * y, kUnit)};
  }
  /// The site's tiles with cells whose middles lie from `lowest` on and before `highest`.
  [[nodiscard]] Range tiles_within(std::int64_t lowest, std::int64_t highest) const {
    // Sines and cosines are rounded: 0.1 mm in 100 km.
    const std::int64_t slack = sin_ == 0 ? 0 : 1;
    const std::int64_t first_cell = -floor_div(-(lowest - slack - cell_ / 2), cell_);
    const std::int64_t end_cell = -floor_div(-(highest + slack - cell_ / 2), cell_);
    return {floor_div(first_cell, Tile::kSize), floor_div(end_cell - 1, Tile::kSize)};
  }
  [[nodiscard]] bool in_extent(std::int64_t tx, std::int64_t ty) const {
    return std::max(std::abs(tx), std::abs(ty)) <= kMaxExtent / tile_size();
  }
  [[nodiscard]] std::int64_t tile_size() const { return cell_ * Tile::kSize; }

 private:
  [[nodiscard]] std::int64_t middle(std::int64_t index) const { return index * cell_ + cell_ / 2; }

  Point at_;
  std::int64_t cell_;
  std::int64_t cos_;
  std::int64_t sin_;
};

/// The submap's cells under one tile of the site, by their index there. Unturned, as most submaps
/// are, all cells of a row lie in one row: so no division is spent on each.
class CellsUnder {
 public:
  CellsUnder(const Placement& placement, const TileKey& key, bool turned)
      : placement_(placement),
        corner_{key.tx * Tile::kSize, key.ty * Tile::kSize},
        turned_(turned) {
    for (int i = 0; !turned && i < Tile::kSize; ++i) {
      const CellIndex cell = placement.submap_cell({corner_.x + i, corner_.y + i});
      x_.at(static_cast<std::size_t>(i)) = cell.x;
      y_.at(static_cast<std::size_t>(i)) = cell.y;
    }
  }
  [[nodiscard]] CellIndex operator()(int i) const {
    const int x = i % Tile::kSize;
    const int y = i / Tile::kSize;
    if (turned_) return placement_.submap_cell({corner_.x + x, corner_.y + y});
    return {x_[static_cast<std::size_t>(x)], y_[static_cast<std::size_t>(y)]};
  }

 private:
  const Placement& placement_;
  CellIndex corner_;
  bool turned_;
  std::array<std::int32_t, Tile::kSize> x_{};
  std::array<std::int32_t, Tile::kSize> y_{};
};

/// Reads cells of which neighbours mostly lie in one tile.
class CellReader {
 public:
  CellReader(const HeightMap& map, std::int8_t level)
      : map_(map), at_{level, 0, 0}, tile_(map.find(at_)) {}

  [[nodiscard]] Cell cell(CellIndex index) {
    const TileKey key = HeightMap::tile_of(index, at_.level);
    if (at_ != key) {
      at_ = key;
      tile_ = map_.find(key);
    }
    const int i = HeightMap::index_in_tile(index);
    return tile_ == nullptr || !tile_->known(i) ? Cell{} : tile_->cell(i);
  }

 private:
  const HeightMap& map_;
  TileKey at_;
  const Tile* tile_;
};

bool acceptable(const SubmapPose& pose) {
  const auto near = [](std::int64_t mm) { return std::abs(mm) * kHalfMm <= kMaxExtent; };
  return near(pose.x_mm) && near(pose.y_mm) && near(pose.z_mm);
}

/// A submap's cell with its height in the site; unknown when no map can hold that height.
Cell lifted(const Cell& cell, std::int32_t z_mm) {
  const std::int64_t height_mm = std::int64_t{cell.height_mm} + z_mm;
  const auto fitted = static_cast<std::int32_t>(height_mm);
  if (!cell.known() || fitted != height_mm || !HeightMap::storable(fitted)) return {};
  return {fitted, cell.probability};
}

/// HeightMap::make says how a datum is chosen.
Tile new_tile(const TileKey& key, std::int32_t height_mm) {
  HeightMap scratch(1);
  return scratch.make(key, height_mm);
}

bool fits(const std::optional<Tile>& tile, const Cell& cell) {
  return !tile || !cell.known() || tile->representable(cell.height_mm);
}

/// Returns whether the cell changed.
bool fold_cell(std::optional<Tile>& tile, const TileKey& key, int i, const Cell& seen,
               const Cell& surface, const FoldRules& rules) {
  const Cell before = tile ? tile->cell(i) : Cell{};
  const Cell kept = rules.after_seen_through(before, seen);
  Cell after = rules.after_surface(kept, surface);
  if (!fits(tile, after)) after = kept;
  const bool same = after.known() ? after == before : !before.known();
  if (same) return false;
  if (!tile) tile = new_tile(key, after.height_mm);
  tile->set(i, after);
  return true;
}

void append_tiles(const Placement& placement, const TileKey& key, std::vector<TileKey>& tiles) {
  if (!placement.in_extent(key.tx, key.ty)) return;
  Point low = placement.site_point(key.tx, key.ty);
  Point high = low;
  for (const auto& [dx, dy] : {std::pair{0, 1}, {1, 0}, {1, 1}}) {
    const Point corner = placement.site_point(key.tx + std::int64_t{dx}, key.ty + std::int64_t{dy});
    low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
    high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
  }
  const Range columns = placement.tiles_within(low.x, high.x);
  const Range rows = placement.tiles_within(low.y, high.y);
  for (std::int64_t tx = columns.first; tx <= columns.last; ++tx) {
    for (std::int64_t ty = rows.first; ty <= rows.last; ++ty) {
      if (!placement.in_extent(tx, ty)) continue;
      tiles.push_back({key.level, static_cast<std::int32_t>(tx), static_cast<std::int32_t>(ty)});
    }
  }
}

}  // namespace

std::vector<TileKey> touched_tiles(const Submap& submap) {
  std::vector<TileKey> tiles;
  if (!acceptable(submap.T_site_submap)) return tiles;
  const Placement placement(submap);
  for (const EvidenceLayer layer : {EvidenceLayer::surface, EvidenceLayer::seen_through}) {
    for (const auto& [key, tile] : layer_of(submap, layer).tiles()) {
      append_tiles(placement, key, tiles);
    }
  }
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  return tiles;
}

std::vector<TileKey> site_tiles_under(const TileKey& submap_tile, const Submap& submap) {
  std::vector<TileKey> tiles;
  if (!acceptable(submap.T_site_submap)) return tiles;
  append_tiles(Placement(submap), submap_tile, tiles);
  std::sort(tiles.begin(), tiles.end());
  return tiles;
}

bool fold_into_tile(std::optional<Tile>& tile, const TileKey& key, const Submap& submap,
                    const SensorModel& model) {
  const Placement placement(submap);
  if (!acceptable(submap.T_site_submap) || !placement.in_extent(key.tx, key.ty)) return false;
  const FoldRules rules(model);
  const std::int32_t z_mm = submap.T_site_submap.z_mm;
  const CellsUnder cells_under(placement, key, submap.T_site_submap.yaw_1e4rad != 0);
  CellReader seen_through(submap.seen_through, key.level);
  CellReader surfaces(submap.surface, key.level);
  bool changed = false;
  for (int i = 0; i < Tile::kCells; ++i) {
    const CellIndex from = cells_under(i);
    const Cell seen = lifted(seen_through.cell(from), z_mm);
    const Cell surface = lifted(surfaces.cell(from), z_mm);
    if (!seen.known() && !surface.known()) continue;
    changed |= fold_cell(tile, key, i, seen, surface, rules);
  }
  return changed;
}

std::vector<TileKey> fold(HeightMap& site, const Submap& submap, const SensorModel& model) {
  assert(site.cell_size_mm() == submap.surface.cell_size_mm());
  std::vector<TileKey> changed;
  for (const TileKey& key : touched_tiles(submap)) {
    const Tile* stored = site.find(key);
    std::optional<Tile> tile = stored != nullptr ? std::optional(*stored) : std::nullopt;
    if (!fold_into_tile(tile, key, submap, model)) continue;
    site.insert(key, *tile);
    changed.push_back(key);
  }
  return changed;
}

}  // namespace cairn
