#include "server/world/tile_ledger.h"

namespace cairn::server {

void TileLedger::changed(const TileKey& key, std::uint64_t boot) {
  Entry& entry = entries_[key];
  if (entry.boot != boot) entry.by_others = entry.stamp;
  entry.boot = boot;
  entry.stamp = ++last_stamp_;
}

std::uint64_t TileLedger::news_for(const TileKey& key, std::uint64_t boot) const {
  const auto found = entries_.find(key);
  if (found == entries_.end()) return 0;
  const Entry& entry = found->second;
  return entry.boot == boot && boot != kNobody ? entry.by_others : entry.stamp;
}

}  // namespace cairn::server
