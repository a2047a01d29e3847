#include "core/delta/block.h"

#include <algorithm>

namespace cairn {
namespace {

constexpr int kBlocksPerRow = Tile::kSize / kBlockSize;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Unknown cells are all alike.
bool same(const Cell& a, const Cell& b) { return a == b || (!a.known() && !b.known()); }

Cell cell_or_unknown(const Tile* tile, int i) {
  return tile != nullptr && tile->known(i) ? tile->cell(i) : Cell{};
}

template <class Each>
void for_each_changed(const BlockDelta& delta, Each&& each) {
  for (int i = 0; i < kBlockCells; ++i) {
    if (delta.changed[at(i)]) each(i, delta.cells[at(i)]);
  }
}

}  // namespace

std::size_t BlockKeyHash::operator()(const BlockKey& key) const {
  const std::size_t place = std::size_t{key.block} * 2 + static_cast<std::size_t>(key.layer);
  return TileKeyHash{}(key.tile) ^ (place * 0x9E3779B97F4A7C15ULL);
}

int index_in_tile(std::uint8_t block, int i) {
  return Tile::index((block % kBlocksPerRow) * kBlockSize + i % kBlockSize,
                     (block / kBlocksPerRow) * kBlockSize + i / kBlockSize);
}

BlockPlace place_in_block(int index_in_tile) {
  const int x = index_in_tile % Tile::kSize;
  const int y = index_in_tile / Tile::kSize;
  const int block = (y / kBlockSize) * kBlocksPerRow + x / kBlockSize;
  return {static_cast<std::uint8_t>(block), (y % kBlockSize) * kBlockSize + x % kBlockSize};
}

BlockDelta diff(const Tile* base, const Tile* now, std::uint8_t block) {
  BlockDelta delta;
  const Tile* datum = now != nullptr ? now : base;
  if (datum != nullptr) delta.datum_mm = datum->datum_mm();
  for (int i = 0; i < kBlockCells; ++i) {
    const int cell = index_in_tile(block, i);
    delta.cells[at(i)] = cell_or_unknown(now, cell);
    delta.changed[at(i)] = !same(cell_or_unknown(base, cell), delta.cells[at(i)]);
  }
  return delta;
}

bool apply(HeightMap& map, const BlockKey& key, const BlockDelta& delta) {
  Tile* tile = map.find(key.tile);
  const Tile fresh(delta.datum_mm);
  const Tile& frame = tile != nullptr ? *tile : fresh;
  bool any_known = false;
  bool all_fit = tile != nullptr || HeightMap::storable(delta.datum_mm);
  for_each_changed(delta, [&](int, const Cell& cell) {
    if (!cell.known()) return;
    any_known = true;
    all_fit = all_fit && HeightMap::storable(cell.height_mm) && frame.representable(cell.height_mm);
  });
  if (any_known && !all_fit) return false;
  if (tile == nullptr && any_known) {
    map.insert(key.tile, fresh);
    tile = map.find(key.tile);
  }
  if (tile == nullptr) return true;
  for_each_changed(delta,
                   [&](int i, const Cell& cell) { tile->set(index_in_tile(key.block, i), cell); });
  return true;
}

void SubmapVersions::touch(EvidenceLayer layer, const std::vector<CellIndex>& cells,
                           std::int8_t level) {
  // Sorted by block, so that each block's version rises once.
  std::vector<std::pair<BlockKey, int>> places;
  places.reserve(cells.size());
  for (const CellIndex cell : cells) {
    const BlockPlace place = place_in_block(HeightMap::index_in_tile(cell));
    places.emplace_back(BlockKey{layer, HeightMap::tile_of(cell, level), place.block}, place.cell);
  }
  std::sort(places.begin(), places.end());
  Block* block = nullptr;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i == 0 || places[i].first != places[i - 1].first) {
      block = &blocks_[places[i].first];
      if (block->told) ++block->version;
      block->told = false;
    }
    block->changed_at[at(places[i].second)] = block->version;
  }
}

std::uint32_t SubmapVersions::version(const BlockKey& key) const {
  const auto it = blocks_.find(key);
  return it == blocks_.end() ? 0 : it->second.version;
}

void SubmapVersions::told(const BlockKey& key) {
  const auto it = blocks_.find(key);
  if (it != blocks_.end()) it->second.told = true;
}

void SubmapVersions::restore(const BlockKey& key, std::uint32_t version,
                             const std::bitset<kBlockCells>& ever_changed) {
  Block& block = blocks_[key];
  block.version = version;
  block.told = true;
  for (int i = 0; i < kBlockCells; ++i) {
    block.changed_at[at(i)] = ever_changed[at(i)] ? version : 0;
  }
}

BlockDelta SubmapVersions::changes_since(const BlockKey& key, std::uint32_t base,
                                         const Submap& submap) const {
  BlockDelta delta;
  const Tile* tile = layer_of(submap, key.layer).find(key.tile);
  if (tile != nullptr) delta.datum_mm = tile->datum_mm();
  const auto it = blocks_.find(key);
  if (it == blocks_.end()) return delta;
  for (int i = 0; i < kBlockCells; ++i) {
    if (it->second.changed_at[at(i)] <= base) continue;
    delta.changed.set(at(i));
    delta.cells[at(i)] = cell_or_unknown(tile, index_in_tile(key.block, i));
  }
  return delta;
}

}  // namespace cairn
