#pragma once

#include <cstdint>
#include <set>
#include <unordered_map>
#include <vector>

#include "core/delta/block.h"
#include "core/map/submap.h"
#include "proto/codec/records.h"
#include "proto/sync/server_link.h"
#include "server/store/store.h"

namespace cairn::server {

/// A submap on its way in: what the server holds of it, block by block. Not yet part of the
/// long-term map proper, only laid over it.
class LiveSubmap {
 public:
  LiveSubmap(SubmapId id, std::string robot, int cell_size_mm);
  /// As it was stored.
  LiveSubmap(const SubmapRow& row, const std::vector<BlockRow>& blocks, int cell_size_mm);

  /// Takes a newer head; an older or equal one changes nothing. Returns whether it was news.
  bool take_head(const proto::SubmapHead& head);

  /// It lies elsewhere: the pose graph has moved what its boot placed.
  void move_to(const SubmapPose& T_site_submap, std::uint32_t edition);

  struct Outcome {
    proto::Verdict verdict = proto::Verdict::stale;
    std::uint32_t held = 0;  ///< Version now held of that block.
  };
  /// Applies an update by the rule of `judge`. A delta that does not fit the block's datum is
  /// refused with nothing held, so that the robot sends the whole block.
  Outcome take_block(const proto::BlockUpdate& update);

  /// Closed, and everything that the head promised is here.
  [[nodiscard]] bool complete() const { return row_.state == SubmapState::closed && holds_all(); }
  /// As many blocks, at as high versions, as the head promised.
  [[nodiscard]] bool holds_all() const {
    return versions_.size() == row_.blocks && version_sum_ == row_.final_versions;
  }

  /// Its head has arrived, so it is known where it lies.
  [[nodiscard]] bool placed() const { return row_.head_version > 0; }
  [[nodiscard]] const Submap& submap() const { return submap_; }
  [[nodiscard]] const SubmapRow& row() const { return row_; }
  [[nodiscard]] SubmapRow& row() { return row_; }
  /// The site's tiles that it can touch, as it lies now; none before it is placed.
  [[nodiscard]] const std::set<TileKey>& site_tiles() const { return site_tiles_; }
  [[nodiscard]] BlockRow block_row(const BlockKey& key) const;

  /// [blocks] A submap never holds more; a robot that sends more is refused.
  static constexpr std::size_t kMaxBlocks = proto::kMaxSubmapBlocks;

 private:
  void place();
  SubmapRow row_;
  Submap submap_;
  std::unordered_map<BlockKey, std::uint32_t, BlockKeyHash> versions_;
  std::uint64_t version_sum_ = 0;
  std::set<TileKey> site_tiles_;
};

}  // namespace cairn::server
