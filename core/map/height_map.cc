#include "core/map/height_map.h"

#include <cassert>

namespace cairn {
namespace {

std::int32_t nearest_metre_mm(std::int32_t height_mm) {
  const std::int32_t away_from_zero = height_mm < 0 ? -500 : 500;
  return (height_mm + away_from_zero) / 1000 * 1000;
}

}  // namespace

HeightMap::HeightMap(const HeightMap& other) : cell_size_mm_(other.cell_size_mm_) {
  tiles_.reserve(other.tiles_.size());
  for (const auto& [key, tile] : other.tiles_) tiles_.emplace(key, std::make_unique<Tile>(*tile));
}

HeightMap& HeightMap::operator=(const HeightMap& other) {
  if (this != &other) *this = HeightMap(other);
  return *this;
}

const Tile* HeightMap::find(const TileKey& key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : it->second.get();
}

Tile* HeightMap::find(const TileKey& key) {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : it->second.get();
}

Tile& HeightMap::make(const TileKey& key, std::int32_t height_mm) {
  assert(storable(height_mm));
  std::unique_ptr<Tile>& tile = tiles_[key];
  if (!tile) tile = std::make_unique<Tile>(nearest_metre_mm(height_mm));
  return *tile;
}

void HeightMap::insert(const TileKey& key, const Tile& tile) {
  tiles_[key] = std::make_unique<Tile>(tile);
}

Cell HeightMap::cell(CellIndex index, std::int8_t level) const {
  const Tile* tile = find(tile_of(index, level));
  const int i = index_in_tile(index);
  return tile == nullptr || !tile->known(i) ? Cell{} : tile->cell(i);
}

bool HeightMap::set(CellIndex index, const Cell& cell, std::int8_t level) {
  const TileKey key = tile_of(index, level);
  Tile* tile = find(key);
  if (!cell.known()) {
    if (tile != nullptr) tile->set(index_in_tile(index), Cell{});
    return true;
  }
  if (!storable(cell.height_mm)) return false;
  if (tile == nullptr) tile = &make(key, cell.height_mm);
  if (!tile->representable(cell.height_mm)) return false;
  tile->set(index_in_tile(index), cell);
  return true;
}

std::size_t HeightMap::known_count() const {
  std::size_t count = 0;
  for (const auto& [key, tile] : tiles_) count += static_cast<std::size_t>(tile->known_count());
  return count;
}

}  // namespace cairn
