#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/common/result.h"
#include "core/map/sensor_model.h"
#include "proto/sync/server_link.h"
#include "server/store/store.h"
#include "server/world/corrections.h"
#include "server/world/live_submap.h"
#include "server/world/offer.h"
#include "server/world/snapshot.h"
#include "server/world/tile_ledger.h"

namespace cairn::server {

/// A submap that is part of the long-term map, as the pose graph takes it.
struct MergedSubmap {
  SubmapId id;
  SubmapPose T_site_submap;
  std::optional<SubmapLink> link;
  std::shared_ptr<const HeightMap> surface;
};

/// What the pose graph found out: where submaps lie now, and what that rests on.
struct GraphFindings {
  std::vector<std::pair<SubmapId, SubmapPose>> moves;
  std::vector<LoopRow> loops{};   ///< New or changed.
  std::vector<TriedRow> tried{};  ///< New or changed.
};

/// The long-term map of one site (design §3, §6): the fold of its accepted submaps, with those
/// still arriving laid over it. Owned by one strand; only `snapshot()` may be called from anywhere.
///
/// Evidence goes: stage → commit → acknowledge. Nothing is acknowledged before its transaction is
/// durable; a commit that fails keeps what was staged and is tried again.
class World {
 public:
  /// Loads what the store holds. corrupt when a row cannot be trusted.
  static Result<std::unique_ptr<World>> open(std::unique_ptr<Store> store,
                                             const SensorModel& model);

  /// What became of one frame's evidence.
  struct Staged {
    bool accepted = false;  ///< False: too much is waiting for the disk; the robot will resend.
    std::vector<proto::Refusal> refusals;
  };
  /// Takes the evidence of one frame from a robot's boot into memory and the next transaction.
  Staged stage(const std::string& robot, std::uint64_t boot,
               const proto::ServerLink::Evidence& evidence);

  /// Writes everything staged, folding submaps that became complete into the long-term map in the
  /// same transaction.
  Status commit();
  [[nodiscard]] bool has_staged() const { return !dirty_blocks_.empty() || !dirty_heads_.empty(); }

  /// Makes the newest durable state visible to readers; does nothing while evidence is staged.
  /// Costs in proportion to the tiles that changed.
  void publish();
  [[nodiscard]] std::shared_ptr<const MapSnapshot> snapshot() const;

  /// Submaps folded since this was last asked, in the order of folding.
  std::vector<MergedSubmap> take_merged() { return std::exchange(new_merged_, {}); }
  /// All merged submaps in the order of folding.
  [[nodiscard]] std::vector<SubmapId> merged_in_order() const;
  /// One of them, read from the store.
  Result<MergedSubmap> load_merged(const SubmapId& id);
  Result<GraphFindings> load_findings();
  /// Lays merged submaps elsewhere, with all that the same boots placed since, and folds the tiles
  /// under them anew: one transaction. On an error nothing has moved. Reads every submap that
  /// touches those tiles.
  Status move(const GraphFindings& findings);

  /// What a robot should be told next of the long-term map: submaps of its own that were moved,
  /// and tiles that others changed, nearest first. Only what is merged.
  [[nodiscard]] PreparedOffer offer(const MapNeed& need, const ToldMap& told) const;

  /// A robot's digests against the merged map. What cannot be compared now, because a submap of the
  /// robot's is in one map and not in the other, is left out.
  [[nodiscard]] std::vector<ComparedTile> compare(std::uint64_t boot,
                                                  const proto::MapDigest& digest) const;

  /// A number that has never been used in this site, durable before it is returned.
  Result<std::uint64_t> next_command_id();

  /// Makes a small named value durable (FORMAT.md).
  Status keep_note(const std::string& name, std::string value);
  /// The named values as they were when the store was opened.
  [[nodiscard]] const std::map<std::string, std::string>& notes_at_start() const {
    return notes_at_start_;
  }

  [[nodiscard]] const SiteInfo& site() const { return store_->site(); }
  [[nodiscard]] std::uint64_t submaps() const { return live_.size() + merged_.size(); }
  [[nodiscard]] std::uint64_t merged() const { return merged_.size(); }
  [[nodiscard]] std::uint64_t commits() const { return commits_; }
  /// Reads and checks the whole store.
  Result<StoreReport> verify() { return store_->verify(); }

  /// [blocks] Staged and not yet durable; beyond it evidence is not accepted.
  static constexpr std::size_t kMaxStagedBlocks = 20'000;
  /// [submaps] Live at once in a site; beyond it new ones are not accepted.
  static constexpr std::size_t kMaxLiveSubmaps = 4'096;
  /// [submaps] Of one boot, complete and behind an incomplete one; more are folded without it.
  static constexpr std::size_t kMaxWaitingToFold = 16;

 private:
  World(std::unique_ptr<Store> store, const SensorModel& model);
  Status load();
  LiveSubmap* live(const SubmapId& id, const std::string& robot);
  void mark_dirty_tiles(const LiveSubmap& submap);
  void mark_dirty_tiles(const LiveSubmap& submap, const BlockKey& key);
  [[nodiscard]] std::vector<SubmapId> next_to_fold() const;
  /// Folds complete submaps into the transaction's tiles; returns their ids.
  std::vector<SubmapId> fold_complete(Transaction& transaction);
  /// The live submaps over each tile that is to be published, in their order.
  [[nodiscard]] std::map<TileKey, std::vector<const LiveSubmap*>> live_over_dirty() const;
  [[nodiscard]] std::shared_ptr<const PackedTile> overlaid(
      const TileKey& key, const std::vector<const LiveSubmap*>& submaps) const;

  struct Merged {
    SubmapRow row;
    /// Which it touches where it lies now; empty until somebody needed to know.
    std::vector<TileKey> site_tiles;
    std::uint32_t moved_in = 0;  ///< Edition in which it last moved; 0: not since it was merged.
  };
  /// What a move changes, worked out before anything is written.
  struct Relocation;

  [[nodiscard]] proto::SubmapHead placed(std::uint64_t boot, const proto::SubmapHead& head) const;
  void merge(LiveSubmap& submap);
  Result<LiveSubmap> read_merged(const SubmapRow& row);
  Status know_site_tiles();
  Relocation plan_relocation(const GraphFindings& findings) const;
  Status refold(Relocation& relocation);
  void adopt(Relocation& relocation);
  void note_change(const TileKey& key);
  [[nodiscard]] std::uint32_t folded_up_to(std::uint64_t boot) const;
  void add_moves(const MapNeed& need, const ToldMap& told, PreparedOffer& offer) const;
  void add_tiles(const MapNeed& need, const ToldMap& told, PreparedOffer& offer) const;

  std::unique_ptr<Store> store_;
  SensorModel model_;
  MapSnapshot::Tiles base_;  ///< The fold of all merged submaps.
  std::map<SubmapId, LiveSubmap> live_;
  std::map<SubmapId, Merged> merged_;
  std::vector<MergedSubmap> new_merged_;              ///< Taken by the owner after every commit.
  std::map<std::uint64_t, Corrections> corrections_;  ///< By boot.
  TileLedger ledger_;
  std::set<SubmapId> dirty_heads_;
  std::set<std::pair<SubmapId, BlockKey>> dirty_blocks_;
  std::set<TileKey> dirty_tiles_;  ///< Changed since the last publication.
  std::uint64_t log_sequence_ = 0;
  std::uint64_t merge_order_ = 0;
  std::uint64_t next_command_ = 1;
  std::map<std::string, std::string> notes_at_start_;
  std::uint64_t commits_ = 0;
  mutable std::mutex snapshot_mutex_;  ///< Guards only the pointer below.
  std::shared_ptr<const MapSnapshot> snapshot_;
};

}  // namespace cairn::server
