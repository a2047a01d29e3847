#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>
#include <utility>

#include "core/map/fold.h"
#include "server/world/placing.h"
#include "server/world/world.h"

/// The part of World that moves submaps: what the pose graph found becomes the map.
namespace cairn::server {

struct World::Relocation {
  std::map<SubmapId, SubmapRow> merged;                 ///< Moved, as their rows shall be.
  std::map<SubmapId, SubmapRow> live;                   ///< Carried along.
  std::map<SubmapId, std::vector<TileKey>> site_tiles;  ///< Of those in `merged`, as they will lie.
  std::map<std::uint64_t, Corrections> corrections;     ///< Of the boots that moved.
  std::map<TileKey, std::optional<Tile>> tiles;         ///< To be folded anew.
  std::map<TileKey, std::uint64_t> versions;  ///< Merge order of the last that changed it.
};

std::vector<SubmapId> World::merged_in_order() const {
  std::vector<std::pair<std::uint64_t, SubmapId>> order;
  for (const auto& [id, merged] : merged_) order.emplace_back(merged.row.merge_order, id);
  std::ranges::sort(order);
  std::vector<SubmapId> ids;
  ids.reserve(order.size());
  for (const auto& [place, id] : order) ids.push_back(id);
  return ids;
}

Result<LiveSubmap> World::read_merged(const SubmapRow& row) {
  auto blocks = store_->blocks_of(row.id);
  if (!blocks) return blocks.error();
  return LiveSubmap(row, *blocks, store_->site().cell_size_mm);
}

Result<MergedSubmap> World::load_merged(const SubmapId& id) {
  const auto found = merged_.find(id);
  assert(found != merged_.end());
  const SubmapRow& row = found->second.row;
  auto submap = read_merged(row);
  if (!submap) return submap.error();
  const std::set<TileKey>& tiles = submap->site_tiles();
  found->second.site_tiles.assign(tiles.begin(), tiles.end());
  return MergedSubmap{id, row.T_site_submap, row.link,
                      std::make_shared<const HeightMap>(submap->submap().surface)};
}

Result<GraphFindings> World::load_findings() {
  auto loops = store_->loops();
  if (!loops) return loops.error();
  auto tried = store_->tried();
  if (!tried) return tried.error();
  GraphFindings findings;
  for (const auto& [id, merged] : merged_) {
    findings.moves.emplace_back(id, merged.row.T_site_submap);
  }
  findings.loops = *std::move(loops);
  findings.tried = *std::move(tried);
  return findings;
}

// ---- Moving -------------------------------------------------------------------------------------

Status World::move(const GraphFindings& findings) {
  Transaction transaction;
  transaction.loops = findings.loops;
  transaction.tried = findings.tried;
  if (!findings.moves.empty()) {
    if (Status known = know_site_tiles(); !known) return known;
  }
  Relocation relocation = plan_relocation(findings);
  if (Status folded = refold(relocation); !folded) return folded;
  for (const auto& [id, row] : relocation.merged) transaction.submaps.push_back(row);
  for (const auto& [id, row] : relocation.live) transaction.submaps.push_back(row);
  for (const auto& [boot, corrections] : relocation.corrections) {
    transaction.notes[corrections_note(boot)] = corrections.text();
  }
  for (const auto& [key, tile] : relocation.tiles) {
    if (tile) {
      transaction.tiles.push_back({key, relocation.versions[key], PackedTile::pack(*tile)});
    } else {
      transaction.erased_tiles.push_back(key);
    }
  }
  if (transaction.empty()) return {};
  transaction.notes["log_sequence"] = std::to_string(log_sequence_ + 1);
  if (Status written = store_->commit(transaction); !written) return written;
  ++log_sequence_;
  ++commits_;
  adopt(relocation);
  return {};
}

Status World::know_site_tiles() {
  for (auto& [id, merged] : merged_) {
    if (!merged.site_tiles.empty()) continue;
    if (auto loaded = load_merged(id); !loaded) return loaded.error();
  }
  return {};
}

World::Relocation World::plan_relocation(const GraphFindings& findings) const {
  Relocation relocation;
  std::map<std::uint64_t, const Merged*> newest;  // Of each boot's moved submaps.
  for (const auto& [id, pose] : findings.moves) {
    const auto found = merged_.find(id);
    if (found == merged_.end() || found->second.row.T_site_submap == pose) continue;
    relocation.merged[id] = found->second.row;
    relocation.merged[id].T_site_submap = pose;
    const Merged*& last = newest[id.boot];
    if (last == nullptr || last->row.id.sequence < id.sequence) last = &found->second;
  }
  for (const auto& [boot, merged] : newest) {
    const auto known = corrections_.find(boot);
    Corrections& corrections = relocation.corrections[boot];
    if (known != corrections_.end()) corrections = known->second;
    const std::uint32_t edition = corrections.add(
        merged->row.T_site_submap, relocation.merged.at(merged->row.id).T_site_submap);
    for (auto& [id, row] : relocation.merged) {
      if (id.boot == boot) row.edition = edition;
    }
    for (const auto& [id, live] : live_) {
      if (id.boot != boot || !live.placed()) continue;
      SubmapRow& row = relocation.live[id] = live.row();
      row.T_site_submap = corrections.corrected(row.T_site_submap, row.edition);
      row.edition = edition;
    }
  }
  return relocation;
}

/// The tiles under moved submaps, where they lay and where they will lie, are folded from nothing,
/// all submaps that touch them in the order of their merging: as the audit does.
Status World::refold(Relocation& relocation) {
  const auto touch = [&relocation](const std::vector<TileKey>& keys) {
    for (const TileKey& key : keys) relocation.tiles[key] = std::nullopt;
  };
  for (const auto& [id, row] : relocation.merged) {
    auto submap = read_merged(row);
    if (!submap) return submap.error();
    touch(merged_.at(id).site_tiles);
    auto& tiles = relocation.site_tiles[id];
    tiles.assign(submap->site_tiles().begin(), submap->site_tiles().end());
    touch(tiles);
  }
  if (relocation.tiles.empty()) return {};
  for (const SubmapId& id : merged_in_order()) {
    const auto moved = relocation.merged.find(id);
    const bool moves = moved != relocation.merged.end();
    const SubmapRow& row = moves ? moved->second : merged_.at(id).row;
    const auto& tiles = moves ? relocation.site_tiles.at(id) : merged_.at(id).site_tiles;
    const bool concerned = std::ranges::any_of(
        tiles, [&](const TileKey& key) { return relocation.tiles.contains(key); });
    if (!concerned) continue;
    auto submap = read_merged(row);
    if (!submap) return submap.error();
    for (const TileKey& key : tiles) {
      const auto entry = relocation.tiles.find(key);
      if (entry == relocation.tiles.end()) continue;
      if (fold_into_tile(entry->second, key, submap->submap(), model_)) {
        relocation.versions[key] = row.merge_order;
      }
    }
  }
  return {};
}

void World::adopt(Relocation& relocation) {
  for (const auto& [id, row] : relocation.merged) {
    merged_[id] = {row, std::move(relocation.site_tiles[id]), row.edition};
  }
  for (const auto& [id, row] : relocation.live) {
    LiveSubmap& live = live_.at(id);
    mark_dirty_tiles(live);
    live.move_to(row.T_site_submap, row.edition);
    mark_dirty_tiles(live);
  }
  for (auto& [boot, corrections] : relocation.corrections) {
    corrections_[boot] = std::move(corrections);
  }
  for (const auto& [key, tile] : relocation.tiles) {
    dirty_tiles_.insert(key);
    if (tile) {
      base_[key] = std::make_shared<const PackedTile>(PackedTile::pack(*tile));
    } else {
      base_.erase(key);
    }
    note_change(key);
  }
}

/// Whoever made a tile alone can make it again from where its submaps lie now.
void World::note_change(const TileKey& key) {
  std::set<std::uint64_t> boots;
  for (const auto& [id, merged] : merged_) {
    if (std::ranges::binary_search(merged.site_tiles, key)) boots.insert(id.boot);
  }
  ledger_.changed(key, boots.size() == 1 ? *boots.begin() : TileLedger::kNobody);
}

// ---- What robots are told -----------------------------------------------------------------------

PreparedOffer World::offer(const MapNeed& need, const ToldMap& told) const {
  PreparedOffer prepared;
  prepared.told.edition = told.edition;
  add_moves(need, told, prepared);
  add_tiles(need, told, prepared);
  prepared.offer.edition = prepared.told.edition;
  return prepared;
}

void World::add_moves(const MapNeed& need, const ToldMap& told, PreparedOffer& prepared) const {
  const auto corrections = corrections_.find(need.boot);
  if (corrections == corrections_.end() || corrections->second.edition() == told.edition) return;
  prepared.told.edition = corrections->second.edition();
  auto& moves = prepared.offer.moves;
  for (auto at = merged_.lower_bound({need.boot, 0});
       at != merged_.end() && at->first.boot == need.boot; ++at) {
    const Merged& merged = at->second;
    if (merged.moved_in <= told.edition) continue;
    moves.push_back({at->first.sequence, merged.row.T_site_submap});
  }
  const std::size_t most = proto::MapSender::kMaxMoves;
  if (moves.size() > most) moves.erase(moves.begin(), moves.end() - static_cast<long>(most));
}

void World::add_tiles(const MapNeed& need, const ToldMap& told, PreparedOffer& prepared) const {
  const double tile_m = store_->site().cell_size_mm * Tile::kSize / 1000.0;
  std::vector<std::pair<double, TileKey>> wanted;
  const auto look = [&](const TileKey& key) {
    const double dx_m = (key.tx + 0.5) * tile_m - need.x_m;
    const double dy_m = (key.ty + 0.5) * tile_m - need.y_m;
    const double distance_m = std::hypot(dx_m, dy_m);
    if (distance_m > kOfferRadiusM) return;
    const auto known = told.stamps.find(key);
    const std::uint64_t told_stamp = known == told.stamps.end() ? 0 : known->second;
    const bool news = ledger_.news_for(key, need.boot) > told_stamp;
    if (news || told.differs.contains(key)) wanted.emplace_back(distance_m, key);
  };
  ledger_.for_each(look);
  for (const TileKey& key : told.differs) look(key);  // The server may never have had one.
  std::ranges::sort(wanted);
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  if (wanted.size() > proto::MapSender::kMaxTiles) wanted.resize(proto::MapSender::kMaxTiles);
  const std::uint32_t holds = folded_up_to(need.boot);
  for (const auto& [distance_m, key] : wanted) {
    const auto base = base_.find(key);  // A move may have emptied a tile.
    const PackedTile tile = base != base_.end() ? *base->second : PackedTile::pack(Tile(0));
    prepared.offer.tiles.push_back({key, tile, holds});
    prepared.told.stamps[key] = ledger_.news_for(key, need.boot);
  }
}

std::vector<ComparedTile> World::compare(std::uint64_t boot, const proto::MapDigest& digest) const {
  const bool same_submaps = digest.holds_sequence == folded_up_to(boot);
  std::vector<ComparedTile> compared;
  for (const proto::MapDigest::Tile& tile : digest.tiles) {
    const TileKey key = proto::tile_of(digest, tile);
    const auto base = base_.find(key);
    const std::uint32_t held = base == base_.end() ? 0 : proto::digest_of(*base->second);
    const bool same = held == tile.digest;
    if (same || same_submaps) compared.push_back({key, same, ledger_.news_for(key, boot)});
  }
  return compared;
}

std::uint32_t World::folded_up_to(std::uint64_t boot) const {
  const auto waiting = live_.lower_bound({boot, 0});
  if (waiting != live_.end() && waiting->first.boot == boot) return waiting->first.sequence - 1;
  auto after = merged_.upper_bound({boot, ~std::uint32_t{0}});
  if (after == merged_.begin()) return 0;
  --after;
  return after->first.boot == boot ? after->first.sequence : 0;
}

}  // namespace cairn::server
