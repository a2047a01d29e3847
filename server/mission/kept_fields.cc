#include "server/mission/kept_fields.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cairn::server {

namespace {

/// When more than this part of all cells changed a new field is cheaper.
constexpr std::size_t kMostChanged = 16;

/// The cell of a goal. Requires: within api::kMaxCoordinateM.
CellIndex cell_of(const Eigen::Vector2d& place_m, int cell_size_mm) {
  const double cell_m = cell_size_mm / 1000.0;
  return {static_cast<std::int32_t>(std::floor(place_m.x() / cell_m)),
          static_cast<std::int32_t>(std::floor(place_m.y() / cell_m))};
}

CellIndex goal_of(const PlanTarget& target) {
  return cell_of(target.request.goal_m, target.map->cell_size_mm);
}

}  // namespace

// ---- One field ----------------------------------------------------------------------------------

Status KeptField::follow(const PlanTarget& target) {
  const auto window = window_around(*target.map, {target.request.start_m, target.request.goal_m});
  if (!window) return window.error();
  if (!keeper_ || !(*window == window_)) return start_anew(target, *window);
  if (target.map == map_) return {};
  const auto changes = changes_to(*target.map);
  if (!changes) return start_anew(target, *window);
  keeper_->change(*changes);
  map_ = target.map;
  return {};
}

Status KeptField::start_anew(const PlanTarget& target, const MapWindow& window) {
  keeper_.reset();
  closed_.reset();
  auto heights = heights_in(*target.map, window, min_probability_);
  if (!heights) return heights.error();
  DrivableGrid grid = make_drivable(std::move(*heights), target.planner);
  map_ = target.map;
  window_ = window;
  const CellIndex goal = goal_of(target);
  if (!why_closed(grid, goal).empty()) {
    closed_ = std::move(grid);
    return {};
  }
  auto keeper = FieldKeeper::create(std::move(grid), target.planner, goal);
  if (!keeper) return keeper.error();
  keeper_ = std::move(*keeper);
  return {};
}

std::optional<std::vector<CellChange>> KeptField::changes_to(const MapSnapshot& map) const {
  std::vector<CellChange> changes;
  const std::size_t most = keeper_->grid().open.size() / kMostChanged;
  for (const auto& [key, tile] : map.tiles) {
    const auto before = map_->tiles.find(key);
    if (key.level != 0 || (before != map_->tiles.end() && before->second == tile)) continue;
    compare(key, tile.get(), changes);
    if (changes.size() > most) return {};
  }
  for (const auto& [key, tile] : map_->tiles) {
    if (key.level == 0 && !map.tiles.contains(key)) compare(key, nullptr, changes);
  }
  return changes;
}

void KeptField::compare(const TileKey& key, const PackedTile* tile,
                        std::vector<CellChange>& changes) const {
  const HeightGrid& heights = keeper_->grid().heights;
  const CellIndex low{key.tx * Tile::kSize, key.ty * Tile::kSize};
  HeightGrid now =
      empty_grid(low, {low.x + Tile::kSize - 1, low.y + Tile::kSize - 1}, heights.cell_size_mm)
          .value();
  if (tile != nullptr) draw_tile(now, key, tile->unpack(), min_probability_);
  for (std::size_t i = 0; i < now.height_mm.size(); ++i) {
    const CellIndex cell{low.x + static_cast<std::int32_t>(i) % Tile::kSize,
                         low.y + static_cast<std::int32_t>(i) / Tile::kSize};
    const std::size_t at = heights.at(cell);
    if (heights.height_mm[at] == now.height_mm[i] && heights.probability[at] == now.probability[i])
      continue;
    changes.push_back({cell, now.height_mm[i], now.probability[i]});
  }
}

Path KeptField::plan(const PlanTarget& target) const {
  return keeper_ ? cairn::plan(keeper_->grid(), keeper_->field(), target.request, target.planner)
                 : cairn::plan(*closed_, target.request, target.planner);
}

bool KeptField::fill(Corridor& corridor) const {
  if (keeper_) corridor.fill(keeper_->grid(), keeper_->field());
  return keeper_.has_value();
}

std::size_t KeptField::memory_bytes() const {
  return (keeper_ ? keeper_->memory_bytes() : 0) + (map_ ? map_->memory_bytes : 0);
}

// ---- All of them --------------------------------------------------------------------------------

Status KeptFields::with(const PlanTarget& target, const Use& use) {
  const std::shared_ptr<Entry> entry = find_or_add(target);
  Status followed;
  std::size_t bytes = 0;
  bool keep = false;
  {
    const std::lock_guard lock(entry->mutex);
    followed = entry->field.follow(target);
    if (followed) use(entry->field);
    keep = followed && entry->field.worth_keeping();
    bytes = entry->field.memory_bytes();
  }
  account(entry, bytes, keep);
  return followed;
}

std::shared_ptr<KeptFields::Entry> KeptFields::find_or_add(const PlanTarget& target) {
  const CellIndex goal = goal_of(target);
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(entries_, [&](const std::shared_ptr<Entry>& entry) {
    return entry->site == target.site && entry->goal == goal && entry->planner == target.planner;
  });
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
    return entries_.front();
  }
  auto entry = std::make_shared<Entry>(min_probability_);
  entry->site = target.site;
  entry->goal = goal;
  entry->planner = target.planner;
  entries_.push_front(entry);
  return entry;
}

void KeptFields::account(const std::shared_ptr<Entry>& entry, std::size_t bytes, bool keep) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(entries_, entry);
  if (found == entries_.end()) return;  // Others have pushed it out meanwhile.
  bytes_ = bytes_ - entry->bytes + bytes;
  entry->bytes = bytes;
  if (!keep) drop(found);
  while (bytes_ > most_bytes_ || entries_.size() > kMostFields) drop(std::prev(entries_.end()));
}

void KeptFields::drop(Entries::iterator entry) {
  bytes_ -= (*entry)->bytes;
  entries_.erase(entry);
}

std::size_t KeptFields::memory_bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

std::size_t KeptFields::count() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

}  // namespace cairn::server
