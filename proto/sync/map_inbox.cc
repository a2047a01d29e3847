#include "proto/sync/map_inbox.h"

#include <utility>

namespace cairn::proto {

void MapInbox::on_block(const MapBlock& block) {
  if (block.step != steps_done_ + 1) return;
  if (!tiles_.contains(block.tile) && tiles_.size() >= kMaxTiles) return;
  const auto [entry, fresh] =
      tiles_.try_emplace(block.tile, Staged{Tile(block.content.datum_mm), block.holds_sequence});
  Tile& tile = entry->second.tile;
  for (int i = 0; i < kBlockCells; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!block.content.changed[at]) continue;
    const Cell& cell = block.content.cells.at(at);
    if (cell.known() && !tile.representable(cell.height_mm)) continue;  // Another datum: not ours.
    tile.set(index_in_tile(block.block, i), cell);
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
