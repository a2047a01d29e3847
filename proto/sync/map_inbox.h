#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/map/tile.h"
#include "proto/codec/records.h"
#include "proto/sync/map_sender.h"

namespace cairn::proto {

/// One step of the long-term map, complete: what robots take over at once.
struct MapUpdate {
  struct Part {
    TileKey key;
    Tile tile;
    std::uint32_t holds_sequence = 0;  ///< As in MapPatch.
  };
  std::vector<Part> tiles;
  std::vector<SubmapPlace> moves;
  std::uint32_t edition = 0;
};

/// The robot's half of the long-term map's way down: keeps what came until its commit comes.
class MapInbox {
 public:
  static constexpr std::size_t kMaxTiles = 64;    ///< More are not taken before a commit.
  static constexpr std::size_t kMaxMoves = 4096;  ///< Neither are more moves.

  /// False, changing nothing, when it cannot be read. One of another step brings nothing.
  [[nodiscard]] bool on_patch(const MapPatch& patch);
  void on_move(const SubmapMove& move);
  /// The step, if it is the next one; a repeated commit brings nothing.
  std::optional<MapUpdate> on_commit(const MapCommit& commit);
  /// A new session: steps begin at 1 again, and what was not committed is void.
  void on_session();

 private:
  void take(const BlockUpdate& block, std::uint32_t holds_sequence);
  struct Staged {
    Tile tile;
    std::uint32_t holds_sequence = 0;
  };

  std::map<TileKey, Staged> tiles_;            ///< [Limit: ≤ kMaxTiles]
  std::map<std::uint32_t, SubmapPose> moves_;  ///< By sequence. [Limit: ≤ kMaxMoves]
  std::uint32_t steps_done_ = 0;
};

}  // namespace cairn::proto
