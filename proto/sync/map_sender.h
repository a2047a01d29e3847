#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/map/packed_tile.h"
#include "proto/codec/frame.h"

namespace cairn::proto {

/// Where a submap of the robot's boot lies.
struct SubmapPlace {
  std::uint32_t sequence = 0;
  SubmapPose T_site_submap;
  friend bool operator==(const SubmapPlace&, const SubmapPlace&) = default;
};

/// What a robot shall know of the long-term map next: all of it in one step.
struct MapOffer {
  struct Part {
    TileKey key;
    PackedTile tile;
    std::uint32_t holds_sequence = 0;  ///< As in MapPatch.
  };
  std::vector<Part> tiles;         ///< [Limit: ≤ MapSender::kMaxTiles]
  std::vector<SubmapPlace> moves;  ///< [Limit: ≤ MapSender::kMaxMoves]
  std::uint32_t edition = 0;       ///< As in MapCommit.
};

/// The server's half of the long-term map's way down. One offer at a time: its records are sent
/// until acknowledged, then the commit is. So what the robot uses is always one whole offer: its
/// map never lies partly in an old place and partly in a new one.
class MapSender {
 public:
  static constexpr std::size_t kMaxTiles = 64;
  static constexpr std::size_t kMaxMoves = 4096;

  /// Nothing is being sent: an offer may be made.
  [[nodiscard]] bool idle() const { return items_.empty() && !more_to_pack(); }
  /// Requires: idle(); an offer within its bounds.
  void offer(const MapOffer& offer);

  /// Adds what waits to a frame numbered `number`; returns how many records were added.
  int fill(FrameWriter& frame, std::uint32_t number);
  void on_acked(std::uint32_t number);
  void on_lost(std::uint32_t number);
  [[nodiscard]] bool has_news() const;
  /// Offers that the robot has in full, its commit acknowledged.
  [[nodiscard]] std::uint32_t steps_done() const { return steps_done_; }

 private:
  enum class Where : std::uint8_t { waiting, under_way, acknowledged };
  struct Item {
    Record record;
    Where where = Where::waiting;
    std::uint32_t carrier = 0;  ///< Frame it is under way in.
  };

  [[nodiscard]] bool more_to_pack() const { return unpacked_ || !tiles_.empty(); }
  [[nodiscard]] std::uint32_t step() const { return steps_done_ + 1; }
  /// Blocks of a tile that are not in a patch yet.
  struct Unpacked {
    std::uint32_t holds_sequence = 0;
    std::vector<BlockUpdate> blocks;
  };
  bool pack_next(const FrameWriter& frame);
  void commit_if_all_acknowledged();

  std::vector<Item> items_;
  std::vector<MapOffer::Part> tiles_;  ///< Of the offer, still to come, the first one last.
  std::optional<Unpacked> unpacked_;
  std::uint32_t edition_ = 0;
  std::uint32_t steps_done_ = 0;
  bool committing_ = false;  ///< The one item left is the commit.
};

}  // namespace cairn::proto
