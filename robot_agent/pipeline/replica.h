#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/map/fold.h"
#include "core/map/sensor_model.h"
#include "proto/sync/digest_sender.h"

namespace cairn::agent {

/// A long-term tile as the server sends it.
struct GivenTile {
  TileKey key;
  Tile tile;
  /// The newest submap of this boot that is folded into it, and with it all before; 0: none.
  std::uint32_t holds_up_to_sequence = 0;
};

/// The robot's own replica of the long-term map: tiles that the server gave, and on top of them the
/// robot's own submaps of this boot that they do not hold yet. Each tile is always what folding
/// them anew would give. Twice: as it is now, and `old` without the newest submaps.
class Replica {
 public:
  /// [submaps] Kept to be moved.
  static constexpr std::size_t kMaxSubmaps = 2'000;
  /// [tiles] That the server gave.
  static constexpr std::size_t kMaxTiles = 8'000;

  Replica(int cell_size_mm, const SensorModel& model, std::size_t kept_bytes);

  [[nodiscard]] const HeightMap& now() const { return now_.map; }
  [[nodiscard]] const HeightMap& old() const { return old_.map; }
  /// Whether the server gave what is known at this place, from before this boot.
  [[nodiscard]] bool given_at(double x_m, double y_m) const;

  /// Lays a closed submap on top. Sequences ascend. Beyond kMaxSubmaps or the byte bound the oldest
  /// becomes a fixed part of the tiles.
  void add(Submap closed);
  /// The submaps up to this one are old from now on. Never goes back.
  void age(std::uint32_t sequence);
  /// Tiles beyond kMaxTiles are passed over.
  void take(const std::vector<GivenTile>& tiles);
  /// Places kept submaps anew; those that are not kept (any more) are passed over.
  void move(const std::vector<std::pair<std::uint32_t, SubmapPose>>& poses);
  /// Forgets tiles whose middle is farther from a place than this.
  void forget_beyond(double x_m, double y_m, double radius_m);

  /// Of the tiles as they are now, by region. Those in which an own submap later than `held_up_to`
  /// lies are left out: the server has it not yet. Reads every tile.
  [[nodiscard]] std::vector<proto::MapDigest> digests(std::uint32_t held_up_to) const;

  /// Null when it is not kept.
  [[nodiscard]] const Submap* find(std::uint32_t sequence) const;
  /// Where the kept submaps that are later than this one lie.
  [[nodiscard]] std::vector<std::pair<std::uint32_t, SubmapPose>> placed_after(
      std::uint32_t sequence) const;
  [[nodiscard]] std::size_t submaps() const { return submaps_.size(); }

 private:
  struct Kept {
    Submap submap;
    std::vector<TileKey> touches;  ///< Sorted.
    std::size_t bytes = 0;
  };
  /// A tile and which of the own submaps are in it.
  struct Base {
    Tile tile;
    std::uint32_t holds = 0;
  };
  /// What the server gave: first the newest from before this boot, then the newest; either may
  /// be missing.
  using Bases = std::vector<Base>;
  struct Layer {
    HeightMap map;
    std::uint32_t up_to;  ///< Own submaps up to this one are in it.
  };

  void lay(Layer& layer, const TileKey& key);
  void lay(const std::vector<TileKey>& keys);
  void fix_oldest();
  void drop_bases_with(const Kept& moved);

  SensorModel model_;
  std::size_t bytes_bound_;
  Layer now_;
  Layer old_;
  std::unordered_map<TileKey, Bases, TileKeyHash> bases_;
  std::deque<Kept> submaps_;  ///< By sequence. [Limit: ≤ kMaxSubmaps]
  std::size_t bytes_ = 0;
};

}  // namespace cairn::agent
