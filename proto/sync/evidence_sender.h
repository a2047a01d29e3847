#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/delta/block.h"
#include "proto/codec/frame.h"
#include "proto/sync/patch_sender.h"

namespace cairn::proto {

/// A submap as it can be kept outside the link until the server holds it: every block whole, told
/// from version 0.
struct KeptSubmap {
  SubmapId id;
  SubmapPose T_site_submap;
  std::uint32_t edition = 0;  ///< As in SubmapHead.
  std::optional<SubmapLink> link;
  std::vector<BlockUpdate> blocks;  ///< [Limit: ≤ kMaxSubmapBlocks]
};

/// The robot's half of evidence synchronisation: owns the submaps that the server does not yet
/// durably hold in full, and knows for each block the newest version, the acknowledged version and
/// what is under way. State, not a log: what is sent is always the newest value of what the peer
/// lacks (design §5.2).
class EvidenceSender {
 public:
  /// [submaps] Hard bound; at it the oldest closed submap is dropped and counted.
  static constexpr std::size_t kMaxSubmaps = 512;
  /// A head's version once a submap that was taken up again is closed: above any that its maker
  /// told of it.
  static constexpr std::uint32_t kAdoptedCloses = 3;

  /// Begins a new submap (sequence one above the last); it becomes the open one. The open one
  /// before it must have been closed. Returns its reference, valid until it is closed.
  /// Its link may be set until it is first sent.
  Submap& begin(std::uint64_t boot, SubmapPose T_site_submap, int cell_size_mm);
  /// Submaps that begin from now on are placed by this edition of the server's map (SubmapHead).
  void set_edition(std::uint32_t edition) { edition_ = edition; }
  /// The open submap's cells changed (its surface or seen_through was written by the caller).
  /// Requires: an open submap; at most kMaxSubmapBlocks blocks in it.
  void touch(EvidenceLayer layer, const std::vector<CellIndex>& cells);
  /// The robot will add nothing more to the open submap.
  void close();
  /// Forgets the open submap, of which nothing was ever told; the next one takes its sequence.
  /// Requires: an open submap that was never touched.
  void discard();
  [[nodiscard]] Submap* open_submap();
  // ---- For who keeps a copy outside: what is here, and what went.

  struct Unheld {
    SubmapId id;
    std::uint64_t revision = 0;  ///< Counts changes of what a copy would hold.
    bool closed = false;
  };
  /// All submaps here, those of this boot first, in their order.
  [[nodiscard]] std::vector<Unheld> unheld() const;
  /// nullopt when it is not here (any more). Costs time in
  /// proportion to its blocks.
  [[nodiscard]] std::optional<KeptSubmap> copy_of(const SubmapId& id) const;
  /// Takes up a submap to which nothing will be added, made by this `boot` or an earlier one. What
  /// the server holds of it is found out by sending. False, changing nothing, when it is here
  /// already, there is no room, or its blocks contradict each other.
  bool adopt(const KeptSubmap& kept, std::uint64_t boot, int cell_size_mm);
  struct Departure {
    SubmapId id;
    bool held = false;  ///< By the server, in full and durably; else it was dropped.
  };
  /// Submaps that left since this was last asked; nobody asking, the newest kMaxSubmaps.
  [[nodiscard]] std::vector<Departure> take_departures();

  /// How finely the caller writes the submaps, for their patches.
  void set_coarseness(const Coarseness& coarseness) { patches_.set_coarseness(coarseness); }

  /// Where the robot is in the open submap: what changed there goes first.
  void set_view(const Viewpoint& view) { view_ = view; }

  /// Evidence sets out (again) after frame `last_number`: every block that now has news, once.
  /// What changes meanwhile waits for the next round, so that on a slow link rounds become longer
  /// and cells that change again and again travel less often.
  void begin_round(std::uint32_t last_number);

  /// Adds what the peer lacks most to a frame numbered `number`, oldest submap first, after them
  /// those of earlier boots. A block with
  /// a delta under way waits until that is acknowledged or lost, so that no cell travels twice for
  /// nothing. Until a head is acknowledged, every frame with blocks of its submap carries it too:
  /// the peer never meets a block of a submap it does not know. Numbers ascend. Returns how many
  /// records were added.
  int fill(FrameWriter& frame, std::uint32_t number);
  /// Also for a frame judged lost before, while its number is within Flight::kReach of the newest.
  void on_acked(std::uint32_t number);
  /// What frame `number` carried must be sent again (in its then newest form), in the round that
  /// goes on, or in the next when that has ended.
  void on_lost(std::uint32_t number);
  /// The peer holds less than it acknowledged (it never acknowledges the frame it refused).
  void on_refused(const Refusal& refusal);
  /// The peer lost the common ground of the patches; what was under way comes to be lost.
  void on_ground_lost(const GroundLost& lost) { patches_.on_ground_lost(lost.epoch); }
  /// A new session or store epoch: nothing is under way any more; with `forget_acked` nothing
  /// counts as held either.
  void on_session(bool forget_acked);

  /// The server holds all of this boot's submaps up to this sequence, except dropped ones.
  [[nodiscard]] std::uint32_t held_up_to() const;
  [[nodiscard]] bool has_news() const;               ///< A round would have something to send.
  [[nodiscard]] bool round_has_news() const;         ///< `fill` would add something.
  [[nodiscard]] bool synchronised() const;           ///< The peer holds everything.
  [[nodiscard]] std::size_t backlog_blocks() const;  ///< Blocks not acknowledged at their newest.
  [[nodiscard]] std::size_t submaps() const;
  [[nodiscard]] std::uint64_t dropped_submaps() const;

 private:
  struct Block {
    std::uint32_t acked = 0;
    std::uint32_t under_way = 0;  ///< Version under way; 0 = none. At most one at a time.
    std::uint32_t carrier = 0;    ///< Number of the frame it is under way in.
    std::uint64_t last_sent = 0;  ///< Turn in which it was last sent; 0 = never.
  };
  struct Head {
    SubmapHead newest;
    std::uint32_t acked = 0;
    std::uint32_t under_way = 0;
    std::uint32_t carrier = 0;
  };
  /// A block's place in the queue: least recently sent first, then by key.
  using Turn = std::pair<std::uint64_t, BlockKey>;
  struct Outgoing {
    Outgoing(SubmapId id, SubmapPose pose, int cell_size_mm);
    [[nodiscard]] bool head_is_news() const;
    [[nodiscard]] bool held() const;  ///< Closed, and the peer has all of it.
    /// A block waits that was sent in no turn after this one.
    [[nodiscard]] bool waits_since(std::uint64_t turn) const {
      return !waiting.empty() && waiting.begin()->first <= turn;
    }

    Submap submap;
    std::uint64_t revision = 0;
    bool adopted = false;  ///< Its head closes when all else is acknowledged.
    SubmapVersions versions;
    Head head;
    std::map<BlockKey, Block> blocks;
    std::set<Turn> waiting;  ///< Blocks to be sent: newer than acknowledged, not under way.
    std::size_t blocks_under_way = 0;
  };
  /// What a frame carried.
  struct Cargo {
    struct Item {
      std::uint32_t sequence = 0;
      std::optional<BlockKey> block;  ///< nullopt: the head.
      std::uint32_t version = 0;
    };
    std::vector<Item> items;
  };

  void drop_oldest_closed();
  void leave(std::map<std::uint32_t, Outgoing>::iterator submap, bool held);
  [[nodiscard]] const Outgoing* find(const SubmapId& id) const;
  /// Closes an adopted submap's head when the rest is acknowledged, and opens it again otherwise.
  static void settle_head(Outgoing& outgoing);
  int fill_from(Outgoing& outgoing, FrameWriter& frame, std::uint32_t number, Cargo& cargo);
  bool add_head(Outgoing& outgoing, FrameWriter& frame, std::uint32_t number, Cargo& cargo);
  int add_blocks(Outgoing& outgoing, FrameWriter& frame, std::uint32_t number, Cargo& cargo);
  [[nodiscard]] std::vector<BlockUpdate> next_updates(const Outgoing& outgoing,
                                                      std::size_t room_bytes) const;
  [[nodiscard]] std::vector<BlockKey> in_turn(const Outgoing& outgoing) const;
  void set_out(Outgoing& outgoing, const BlockUpdate& update, std::uint32_t number, Cargo& cargo);
  void item_acked(const Cargo::Item& item);
  void item_lost(const Cargo::Item& item, std::uint32_t number);
  Outgoing* find(std::uint32_t sequence);
  /// Puts a block where it belongs: waiting when it has news and is not under way.
  static void queue(Outgoing& outgoing, const BlockKey& key, Block& block);
  static void no_longer_under_way(Outgoing& outgoing, Block& block);

  /// By sequence, those of earlier boots by a borrowed one: they come last. [Limit: ≤ kMaxSubmaps]
  std::map<std::uint32_t, Outgoing> submaps_;
  std::vector<Departure> departures_;  ///< [Limit: ≤ kMaxSubmaps]
  std::uint32_t next_borrowed_ = kFirstBorrowedSequence;
  /// Frames the peer may still acknowledge, also such as were judged lost. [Limit: ≤
  /// Flight::kReach]
  std::map<std::uint32_t, Cargo> cargoes_;
  PatchSender patches_;
  std::uint32_t last_sequence_ = 0;
  std::uint32_t edition_ = 0;
  std::uint64_t turn_ = 0;
  /// The last turn before the round; before the first round everything may go.
  std::uint64_t round_turn_ = std::numeric_limits<std::uint64_t>::max();
  std::optional<Viewpoint> view_;  ///< In the open submap.
  std::uint64_t dropped_submaps_ = 0;
};

}  // namespace cairn::proto
