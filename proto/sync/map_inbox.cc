#include "proto/sync/map_inbox.h"

#include <utility>

#include "proto/codec/patch.h"

namespace cairn::proto {

bool MapInbox::on_patch(const MapPatch& patch) {
  if (patch.step != steps_done_ + 1) return true;
  const auto blocks = read_patch(patch.bytes, {}, {});
  if (!blocks) return false;
  for (const BlockUpdate& block : *blocks) take(block, patch.holds_sequence);
  return true;
}

void MapInbox::take(const BlockUpdate& block, std::uint32_t holds_sequence) {
  const TileKey& key = block.key.tile;
  if (!tiles_.contains(key) && tiles_.size() >= kMaxTiles) return;
  const auto [entry, fresh] =
      tiles_.try_emplace(key, Staged{Tile(block.delta.datum_mm), holds_sequence});
  Tile& tile = entry->second.tile;
  for (int i = 0; i < kBlockCells; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!block.delta.changed[at]) continue;
    const Cell& cell = block.delta.cells.at(at);
    if (cell.known() && !tile.representable(cell.height_mm)) continue;  // Another datum: not ours.
    tile.set(index_in_tile(block.key.block, i), cell);
  }
}

void MapInbox::on_move(const SubmapMove& move) {
  if (move.step != steps_done_ + 1) return;
  if (moves_.size() < kMaxMoves || moves_.contains(move.sequence)) {
    moves_[move.sequence] = move.T_site_submap;
  }
}

std::optional<MapUpdate> MapInbox::on_commit(const MapCommit& commit) {
  if (commit.step != steps_done_ + 1) return std::nullopt;
  steps_done_ = commit.step;
  MapUpdate update;
  update.edition = commit.edition;
  for (const auto& [key, staged] : tiles_) {
    update.tiles.push_back({key, staged.tile, staged.holds_sequence});
  }
  for (const auto& [sequence, pose] : moves_) update.moves.push_back({sequence, pose});
  tiles_.clear();
  moves_.clear();
  return update;
}

void MapInbox::on_session() {
  tiles_.clear();
  moves_.clear();
  steps_done_ = 0;
}

}  // namespace cairn::proto
