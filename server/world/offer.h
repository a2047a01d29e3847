#pragma once

#include <cstdint>
#include <unordered_map>
#include <unordered_set>

#include "core/map/tile.h"
#include "proto/sync/map_sender.h"

namespace cairn::server {

/// What a robot was told of the long-term map in this session.
struct ToldMap {
  std::unordered_map<TileKey, std::uint64_t, TileKeyHash> stamps;  ///< As from TileLedger.
  std::uint32_t edition = 0;
  /// Tiles that the robot turned out to hold otherwise, though it was told all or made it itself.
  std::unordered_set<TileKey, TileKeyHash> differs{};
};

/// How a robot's tile compares with the server's.
struct ComparedTile {
  TileKey key;
  bool same = false;
  std::uint64_t stamp = 0;  ///< Of the newest news for the robot in it, as from TileLedger.
};

/// Who asks for the long-term map, and where the need is greatest.
struct MapNeed {
  std::uint64_t boot = 0;
  double x_m = 0.0;
  double y_m = 0.0;
};

/// The next step for a robot, and what it will have been told once it has it.
struct PreparedOffer {
  proto::MapOffer offer;
  ToldMap told;  ///< Only the tiles of this offer.
  [[nodiscard]] bool empty() const { return offer.tiles.empty() && offer.moves.empty(); }
};

/// [m] A robot is told of tiles this near to it; it keeps no others (Mapper::kKeepRadiusM).
inline constexpr double kOfferRadiusM = 150.0;

}  // namespace cairn::server
