#pragma once

#include <cstdint>
#include <unordered_map>

#include "core/map/tile.h"

namespace cairn::server {

/// Who changed each tile of the long-term map last, so that a robot is told only what it cannot
/// know by itself (design §5.5). Boots name robots' runs; kNobody stands for what no robot can
/// follow by itself, such as a map whose history was not read.
class TileLedger {
 public:
  static constexpr std::uint64_t kNobody = 0;

  void changed(const TileKey& key, std::uint64_t boot);
  /// Stamp of the newest change that this boot did not make itself; 0: there is none. Stamps grow.
  [[nodiscard]] std::uint64_t news_for(const TileKey& key, std::uint64_t boot) const;

  /// Calls `look(key)` for every tile that ever changed.
  template <class Look>
  void for_each(Look look) const {
    for (const auto& [key, entry] : entries_) look(key);
  }

 private:
  struct Entry {
    std::uint64_t boot = kNobody;  ///< Who made the newest change.
    std::uint64_t stamp = 0;
    std::uint64_t by_others = 0;  ///< Stamp of the newest change by anybody else.
  };
  std::unordered_map<TileKey, Entry, TileKeyHash> entries_;
  std::uint64_t last_stamp_ = 0;
};

}  // namespace cairn::server
