#include "robot_agent/pipeline/replica.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

namespace cairn::agent {

namespace {

constexpr std::uint32_t kAll = std::numeric_limits<std::uint32_t>::max();

std::size_t bytes_of(const Submap& submap) {
  return (submap.surface.tiles().size() + submap.seen_through.tiles().size()) * sizeof(Tile);
}

void merge_into(std::vector<TileKey>& keys, const std::vector<TileKey>& more) {
  keys.insert(keys.end(), more.begin(), more.end());
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

}  // namespace

Replica::Replica(int cell_size_mm, const SensorModel& model, std::size_t kept_bytes)
    : model_(model),
      bytes_bound_(kept_bytes),
      now_{HeightMap(cell_size_mm), kAll},
      old_{HeightMap(cell_size_mm), 0} {}

bool Replica::given_at(double x_m, double y_m) const {
  const auto found = bases_.find(HeightMap::tile_of(now_.map.cell_at(x_m, y_m)));
  return found != bases_.end() && found->second.front().holds == 0;
}

void Replica::add(Submap closed) {
  assert(submaps_.empty() || submaps_.back().submap.id.sequence < closed.id.sequence);
  (void)fold(now_.map, closed, model_);
  Kept kept{std::move(closed), {}, 0};
  kept.touches = touched_tiles(kept.submap);
  kept.bytes = bytes_of(kept.submap);
  bytes_ += kept.bytes;
  submaps_.push_back(std::move(kept));
  while (submaps_.size() > kMaxSubmaps || (bytes_ > bytes_bound_ && submaps_.size() > 1)) {
    fix_oldest();
  }
}

void Replica::fix_oldest() {
  const Kept& oldest = submaps_.front();
  const std::uint32_t sequence = oldest.submap.id.sequence;
  for (const TileKey& key : oldest.touches) {
    if (now_.map.find(key) == nullptr) continue;  // Forgotten: too far away.
    Bases& bases = bases_[key];
    if (bases.empty()) bases.push_back({Tile(0), 0});
    for (Base& base : bases) {
      if (base.holds >= sequence) continue;
      std::optional<Tile> tile;
      if (base.tile.known_count() > 0) tile = base.tile;
      if (fold_into_tile(tile, key, oldest.submap, model_)) base.tile = *tile;
      base.holds = sequence;
    }
  }
  old_.up_to = std::max(old_.up_to, sequence);
  bytes_ -= oldest.bytes;
  submaps_.pop_front();
}

void Replica::age(std::uint32_t sequence) {
  if (sequence <= old_.up_to) return;
  std::vector<TileKey> keys;
  for (const Kept& kept : submaps_) {
    const std::uint32_t own = kept.submap.id.sequence;
    if (own > old_.up_to && own <= sequence) merge_into(keys, kept.touches);
  }
  old_.up_to = sequence;
  for (const TileKey& key : keys) lay(old_, key);
}

void Replica::take(const std::vector<GivenTile>& tiles) {
  std::vector<TileKey> keys;
  for (const GivenTile& given : tiles) {
    if (bases_.size() >= kMaxTiles && !bases_.contains(given.key)) continue;
    Bases& bases = bases_[given.key];
    const Base base{given.tile, given.holds_up_to_sequence};
    // One from before this boot stays, for the day when own submaps in a newer one are moved.
    const bool keep_first = !bases.empty() && bases.front().holds == 0 && base.holds != 0;
    bases.resize(keep_first ? 1 : 0, base);
    bases.push_back(base);
    keys.push_back(given.key);
  }
  lay(keys);
}

void Replica::move(const std::vector<std::pair<std::uint32_t, SubmapPose>>& poses) {
  std::vector<TileKey> keys;
  for (const auto& [sequence, pose] : poses) {
    const auto kept = std::find_if(
        submaps_.begin(), submaps_.end(),
        [sequence = sequence](const Kept& each) { return each.submap.id.sequence == sequence; });
    if (kept == submaps_.end() || kept->submap.T_site_submap == pose) continue;
    merge_into(keys, kept->touches);
    drop_bases_with(*kept);
    kept->submap.T_site_submap = pose;
    kept->touches = touched_tiles(kept->submap);
    merge_into(keys, kept->touches);
  }
  lay(keys);
}

/// Tiles in which a submap lies where it no longer does: the server will give them anew.
void Replica::drop_bases_with(const Kept& moved) {
  for (const TileKey& key : moved.touches) {
    const auto found = bases_.find(key);
    if (found == bases_.end()) continue;
    std::erase_if(found->second,
                  [&](const Base& base) { return base.holds >= moved.submap.id.sequence; });
    if (found->second.empty()) bases_.erase(found);
  }
}

void Replica::lay(const std::vector<TileKey>& keys) {
  for (const TileKey& key : keys) {
    lay(now_, key);
    lay(old_, key);
  }
}

void Replica::lay(Layer& layer, const TileKey& key) {
  std::optional<Tile> tile;
  std::uint32_t holds = 0;
  if (const auto found = bases_.find(key); found != bases_.end()) {
    for (const Base& base : found->second) {
      if (base.holds > layer.up_to) continue;
      if (base.tile.known_count() > 0) tile = base.tile;
      holds = base.holds;
    }
  }
  for (const Kept& kept : submaps_) {
    const std::uint32_t sequence = kept.submap.id.sequence;
    if (sequence <= holds || sequence > layer.up_to) continue;
    if (!std::binary_search(kept.touches.begin(), kept.touches.end(), key)) continue;
    (void)fold_into_tile(tile, key, kept.submap, model_);
  }
  layer.map.erase(key);
  if (tile) layer.map.insert(key, *tile);
}

void Replica::forget_beyond(double x_m, double y_m, double radius_m) {
  const double tile_m = now_.map.cell_size_m() * Tile::kSize;
  const auto far = [&](const TileKey& key) {
    return std::hypot((key.tx + 0.5) * tile_m - x_m, (key.ty + 0.5) * tile_m - y_m) > radius_m;
  };
  std::vector<TileKey> keys;
  for (const auto& [key, tile] : now_.map.tiles()) {
    if (far(key)) keys.push_back(key);
  }
  for (const auto& [key, bases] : bases_) {
    if (far(key)) keys.push_back(key);
  }
  for (const TileKey& key : keys) {
    now_.map.erase(key);
    old_.map.erase(key);
    bases_.erase(key);
  }
}

std::vector<proto::MapDigest> Replica::digests(std::uint32_t held_up_to) const {
  std::vector<TileKey> ahead;
  for (const Kept& kept : submaps_) {
    if (kept.submap.id.sequence > held_up_to) merge_into(ahead, kept.touches);
  }
  std::map<proto::Region, proto::MapDigest> regions;
  for (const auto& [key, tile] : now_.map.tiles()) {
    if (std::binary_search(ahead.begin(), ahead.end(), key)) continue;
    const proto::Region region = proto::region_of(key);
    proto::MapDigest& digest = regions[region];
    digest.holds_sequence = held_up_to;
    digest.level = region.level;
    digest.rx = region.rx;
    digest.ry = region.ry;
    digest.tiles.push_back({proto::place_of(key), proto::digest_of(PackedTile::pack(*tile))});
  }
  std::vector<proto::MapDigest> all;
  for (auto& [region, digest] : regions) {
    std::ranges::sort(digest.tiles, {}, &proto::MapDigest::Tile::place);
    all.push_back(std::move(digest));
  }
  return all;
}

std::vector<std::pair<std::uint32_t, SubmapPose>> Replica::placed_after(
    std::uint32_t sequence) const {
  std::vector<std::pair<std::uint32_t, SubmapPose>> later;
  for (const Kept& kept : submaps_) {
    if (kept.submap.id.sequence <= sequence) continue;
    later.emplace_back(kept.submap.id.sequence, kept.submap.T_site_submap);
  }
  return later;
}

const Submap* Replica::find(std::uint32_t sequence) const {
  for (const Kept& kept : submaps_) {
    if (kept.submap.id.sequence == sequence) return &kept.submap;
  }
  return nullptr;
}

}  // namespace cairn::agent
