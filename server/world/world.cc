#include "server/world/world.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "core/map/fold.h"

namespace cairn::server {

namespace {

constexpr const char* kLogSequence = "log_sequence";
constexpr const char* kNextCommand = "next_command";

std::uint64_t number_in(const std::map<std::string, std::string>& notes, const char* name,
                        std::uint64_t otherwise) {
  const auto found = notes.find(name);
  if (found == notes.end()) return otherwise;
  std::uint64_t value = otherwise;
  std::from_chars(found->second.data(), found->second.data() + found->second.size(), value);
  return value;
}

/// Table entry of a tile: key, shared pointer, node and bucket, control block and object.
constexpr std::size_t kTileOverheadBytes =
    sizeof(MapSnapshot::Tiles::value_type) + 2 * sizeof(void*) + sizeof(PackedTile) + 16;

void count_memory(MapSnapshot& snapshot) {
  snapshot.known_cells = 0;
  snapshot.memory_bytes = 0;
  for (const auto& [key, tile] : snapshot.tiles) {
    snapshot.known_cells += static_cast<std::uint64_t>(tile->known_count());
    snapshot.memory_bytes += tile->bytes().size() + kTileOverheadBytes;
  }
}

}  // namespace

World::World(std::unique_ptr<Store> store, const SensorModel& model)
    : store_(std::move(store)), model_(model) {}

Result<std::unique_ptr<World>> World::open(std::unique_ptr<Store> store, const SensorModel& model) {
  std::unique_ptr<World> world(new World(std::move(store), model));
  if (Status loaded = world->load(); !loaded) return loaded.error();
  world->publish();
  return world;
}

Status World::load() {
  auto notes = store_->notes();
  if (!notes) return notes.error();
  log_sequence_ = number_in(*notes, kLogSequence, 0);
  next_command_ = number_in(*notes, kNextCommand, 1);
  notes_at_start_ = *notes;

  auto tiles = store_->tiles();
  if (!tiles) return tiles.error();
  for (TileRow& row : *tiles) {
    ledger_.changed(row.key, TileLedger::kNobody);
    dirty_tiles_.insert(row.key);
    base_[row.key] = std::make_shared<const PackedTile>(std::move(row.tile));
  }
  for (const auto& [name, text] : *notes) {
    const auto boot = boot_of_note(name);
    if (!boot) continue;
    auto corrections = Corrections::from_text(text);
    if (!corrections) return corrections.error();
    corrections_[*boot] = *std::move(corrections);
  }

  auto submaps = store_->submaps();
  if (!submaps) return submaps.error();
  for (const SubmapRow& row : *submaps) {
    merge_order_ = std::max(merge_order_, row.merge_order);
    if (row.state == SubmapState::merged) {
      const auto moved = corrections_.find(row.id.boot);
      merged_[row.id] = {row, {}, moved == corrections_.end() ? 0 : moved->second.edition()};
      continue;
    }
    auto blocks = store_->blocks_of(row.id);
    if (!blocks) return blocks.error();
    const auto [entry, inserted] =
        live_.try_emplace(row.id, row, *blocks, store_->site().cell_size_mm);
    mark_dirty_tiles(entry->second);
  }
  return {};
}

LiveSubmap* World::live(const SubmapId& id, const std::string& robot) {
  if (const auto found = live_.find(id); found != live_.end()) return &found->second;
  if (live_.size() >= kMaxLiveSubmaps) return nullptr;
  return &live_.try_emplace(id, id, robot, store_->site().cell_size_mm).first->second;
}

World::Staged World::stage(const std::string& robot, std::uint64_t boot,
                           const proto::ServerLink::Evidence& evidence) {
  if (dirty_blocks_.size() >= kMaxStagedBlocks) return {};
  Staged staged{.accepted = true, .refusals = {}};
  for (const proto::SubmapHead& head : evidence.heads) {
    const SubmapId id = evidence.submap(boot, head.sequence);
    if (merged_.contains(id)) continue;
    LiveSubmap* submap = live(id, robot);
    if (submap == nullptr) return {};
    mark_dirty_tiles(*submap);  // Where it lay,
    if (!submap->take_head(placed(id.boot, head))) continue;
    dirty_heads_.insert(id);
    mark_dirty_tiles(*submap);  // and where it lies now.
  }
  for (const proto::BlockUpdate& update : evidence.blocks) {
    const SubmapId id = evidence.submap(boot, update.sequence);
    if (merged_.contains(id)) continue;
    LiveSubmap* submap = live(id, robot);
    if (submap == nullptr) return {};
    const LiveSubmap::Outcome outcome = submap->take_block(update);
    if (outcome.verdict == proto::Verdict::refuse) {
      staged.refusals.push_back({update.sequence, update.key, outcome.held});
    } else if (outcome.verdict == proto::Verdict::apply) {
      dirty_heads_.insert(
          id);  // A block needs its submap's row, even when the head is yet to come.
      dirty_blocks_.emplace(id, update.key);
      mark_dirty_tiles(*submap, update.key);
    }
  }
  return staged;
}

proto::SubmapHead World::placed(std::uint64_t boot, const proto::SubmapHead& head) const {
  const auto found = corrections_.find(boot);
  if (found == corrections_.end()) return head;
  proto::SubmapHead placed = head;
  placed.T_site_submap = found->second.corrected(head.T_site_submap, head.edition);
  placed.edition = found->second.edition();
  return placed;
}

Status World::commit() {
  Transaction transaction;
  const std::vector<SubmapId> folded = fold_complete(transaction);
  for (const SubmapId& id : dirty_heads_) transaction.submaps.push_back(live_.at(id).row());
  for (const auto& [id, key] : dirty_blocks_) {
    transaction.blocks.push_back(live_.at(id).block_row(key));
  }
  if (transaction.empty()) return {};
  transaction.notes[kLogSequence] = std::to_string(log_sequence_ + 1);
  if (Status written = store_->commit(transaction); !written) {
    for (const SubmapId& id : folded) {  // Not merged after all; the next commit tries again.
      live_.at(id).row().state = SubmapState::closed;
      live_.at(id).row().merge_order = 0;
    }
    return written;
  }
  ++log_sequence_;
  ++commits_;
  dirty_heads_.clear();
  dirty_blocks_.clear();
  merge_order_ += folded.size();
  for (TileRow& row : transaction.tiles) {
    dirty_tiles_.insert(row.key);
    base_[row.key] = std::make_shared<const PackedTile>(std::move(row.tile));
  }
  for (const SubmapId& id : folded) merge(live_.at(id));
  return {};
}

void World::merge(LiveSubmap& submap) {
  const SubmapRow& row = submap.row();
  const SubmapId id = row.id;
  mark_dirty_tiles(submap);
  const std::set<TileKey>& tiles = submap.site_tiles();
  for (const TileKey& key : tiles) {
    if (base_.contains(key)) ledger_.changed(key, id.boot);
  }
  merged_[id] = {row, {tiles.begin(), tiles.end()}, 0};
  new_merged_.push_back({id, row.T_site_submap, row.link,
                         std::make_shared<const HeightMap>(submap.submap().surface)});
  live_.erase(id);
}

/// A boot's submaps in their order, as its robot folds them: what is complete waits for what it
/// made before, but not for ever, for some of that may have been lost with the robot's memory.
std::vector<SubmapId> World::next_to_fold() const {
  std::vector<SubmapId> next;
  std::map<std::uint64_t, std::vector<SubmapId>> waiting;  // Behind something incomplete, by boot.
  for (const auto& [id, submap] : live_) {
    const auto behind = waiting.find(id.boot);
    if (!submap.complete()) {
      waiting.try_emplace(id.boot);
    } else if (behind == waiting.end()) {
      next.push_back(id);
    } else {
      behind->second.push_back(id);
    }
  }
  for (const auto& [boot, ids] : waiting) {
    if (ids.size() > kMaxWaitingToFold) next.insert(next.end(), ids.begin(), ids.end());
  }
  return next;
}

std::vector<SubmapId> World::fold_complete(Transaction& transaction) {
  std::vector<SubmapId> folded;
  std::map<TileKey, std::optional<Tile>> tiles;
  std::map<TileKey, std::uint64_t> versions;
  for (const SubmapId& id : next_to_fold()) {
    LiveSubmap& submap = live_.at(id);
    submap.row().state = SubmapState::merged;
    submap.row().merge_order = merge_order_ + folded.size() + 1;
    dirty_heads_.insert(id);
    folded.push_back(id);
    for (const TileKey& key : submap.site_tiles()) {
      const auto [entry, fresh] = tiles.try_emplace(key);
      if (const auto base = base_.find(key); fresh && base != base_.end()) {
        entry->second = base->second->unpack();
      }
      if (fold_into_tile(entry->second, key, submap.submap(), model_)) {
        versions[key] = submap.row().merge_order;
      }
    }
  }
  for (const auto& [key, version] : versions) {
    transaction.tiles.push_back({key, version, PackedTile::pack(*tiles.at(key))});
  }
  return folded;
}

void World::mark_dirty_tiles(const LiveSubmap& submap) {
  dirty_tiles_.insert(submap.site_tiles().begin(), submap.site_tiles().end());
}

void World::mark_dirty_tiles(const LiveSubmap& submap, const BlockKey& key) {
  const std::vector<TileKey> tiles = site_tiles_under(key.tile, submap.submap());
  dirty_tiles_.insert(tiles.begin(), tiles.end());
}

std::map<TileKey, std::vector<const LiveSubmap*>> World::live_over_dirty() const {
  std::map<TileKey, std::vector<const LiveSubmap*>> over;
  for (const TileKey& key : dirty_tiles_) over[key];
  for (const auto& [id, submap] : live_) {
    for (const TileKey& key : submap.site_tiles()) {
      if (const auto found = over.find(key); found != over.end()) found->second.push_back(&submap);
    }
  }
  return over;
}

std::shared_ptr<const PackedTile> World::overlaid(
    const TileKey& key, const std::vector<const LiveSubmap*>& submaps) const {
  const auto base = base_.find(key);
  std::optional<Tile> tile;
  if (base != base_.end()) tile = base->second->unpack();
  bool changed = false;
  for (const LiveSubmap* submap : submaps) {
    changed |= fold_into_tile(tile, key, submap->submap(), model_);
  }
  if (!changed) return base != base_.end() ? base->second : nullptr;
  return std::make_shared<const PackedTile>(PackedTile::pack(*tile));
}

void World::publish() {
  // What is not durable yet is not shown: each version is one map.
  if (snapshot_ && (dirty_tiles_.empty() || has_staged())) return;
  auto next =
      snapshot_ ? std::make_shared<MapSnapshot>(*snapshot_) : std::make_shared<MapSnapshot>();
  next->version = log_sequence_;
  next->cell_size_mm = store_->site().cell_size_mm;
  for (const auto& [key, submaps] : live_over_dirty()) {
    std::shared_ptr<const PackedTile> tile = overlaid(key, submaps);
    if (tile && tile->known_count() > 0) {
      next->tiles[key] = std::move(tile);
    } else {
      next->tiles.erase(key);
    }
  }
  dirty_tiles_.clear();
  count_memory(*next);
  const std::lock_guard lock(snapshot_mutex_);
  snapshot_ = std::move(next);
}

std::shared_ptr<const MapSnapshot> World::snapshot() const {
  const std::lock_guard lock(snapshot_mutex_);
  return snapshot_;
}

Result<std::uint64_t> World::next_command_id() {
  Transaction transaction;
  transaction.notes[kNextCommand] = std::to_string(next_command_ + 1);
  if (Status written = store_->commit(transaction); !written) return written.error();
  return next_command_++;
}

Status World::keep_note(const std::string& name, std::string value) {
  Transaction transaction;
  transaction.notes[name] = std::move(value);
  return store_->commit(transaction);
}

}  // namespace cairn::server
