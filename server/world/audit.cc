#include "server/world/audit.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/map/fold.h"
#include "server/world/live_submap.h"

namespace cairn::server {

namespace {

void add_fault(Audit& audit, std::string fault) {
  if (audit.faults.size() < StoreReport::kMaxFaults) audit.faults.push_back(std::move(fault));
}

std::string name_of(const TileKey& key) {
  return "tile (level " + std::to_string(key.level) + ", " + std::to_string(key.tx) + ", " +
         std::to_string(key.ty) + ")";
}

std::string name_of(const SubmapId& id) {
  return "submap " + std::to_string(id.boot) + "/" + std::to_string(id.sequence);
}

/// Merged submaps in the order of their folding; a gap or a double in the order is a fault.
std::vector<SubmapRow> merged_in_order(std::vector<SubmapRow> rows, Audit& audit) {
  std::erase_if(rows, [](const SubmapRow& row) { return row.state != SubmapState::merged; });
  std::ranges::sort(rows, {}, &SubmapRow::merge_order);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].merge_order == i + 1) continue;
    add_fault(audit, name_of(rows[i].id) + " has merge order " +
                         std::to_string(rows[i].merge_order) + " where " + std::to_string(i + 1) +
                         " was expected");
    break;
  }
  return rows;
}

void compare_tiles(const HeightMap& rebuilt, const std::vector<TileRow>& stored, Audit& audit) {
  std::map<TileKey, const Tile*> missing;
  for (const auto& [key, tile] : rebuilt.tiles()) missing[key] = tile.get();
  for (const TileRow& row : stored) {
    ++audit.compared_tiles;
    const auto found = missing.find(row.key);
    if (found == missing.end()) {
      add_fault(audit, name_of(row.key) + " is stored, but no evidence touches it");
      continue;
    }
    if (!(PackedTile::pack(*found->second) == row.tile)) {
      add_fault(audit, name_of(row.key) + " differs from the fold of its evidence");
    }
    missing.erase(found);
  }
  for (const auto& [key, tile] : missing) {
    add_fault(audit, name_of(key) + " is missing, though evidence touches it");
  }
}

}  // namespace

Result<Audit> audit(Store& store, const SensorModel& model) {
  Audit audit;
  auto report = store.verify();
  if (!report) return report.error();
  audit.store = std::move(*report);
  if (!audit.store.faults.empty()) return audit;  // What cannot be read cannot be folded.

  auto submaps = store.submaps();
  if (!submaps) return submaps.error();
  HeightMap rebuilt(store.site().cell_size_mm);
  for (const SubmapRow& row : merged_in_order(std::move(*submaps), audit)) {
    auto blocks = store.blocks_of(row.id);
    if (!blocks) return blocks.error();
    const LiveSubmap submap(row, *blocks, store.site().cell_size_mm);
    if (!submap.holds_all()) add_fault(audit, name_of(row.id) + " is merged, but lacks blocks");
    fold(rebuilt, submap.submap(), model);
    ++audit.merged_submaps;
  }
  auto tiles = store.tiles();
  if (!tiles) return tiles.error();
  compare_tiles(rebuilt, *tiles, audit);
  return audit;
}

}  // namespace cairn::server
