#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/common/time.h"
#include "proto/codec/frame.h"
#include "proto/sync/ack_log.h"
#include "proto/sync/budget.h"
#include "proto/sync/corridor_sender.h"
#include "proto/sync/flight.h"
#include "proto/sync/map_sender.h"
#include "proto/sync/order_sender.h"
#include "proto/sync/patch_receiver.h"
#include "proto/sync/robot_link.h"

namespace cairn::proto {

/// The server's end of one robot's session, as a state machine without clock, thread or socket.
/// Evidence is handed up frame by frame; the owner commits it and then says `durable(number)`.
class ServerLink {
 public:
  /// Frames that ask for no acknowledgement get one within this time.
  static constexpr Duration kLazyAckDelay = std::chrono::seconds(4);
  /// Evidence after such a break is acknowledged without waiting for more: most likely none comes.
  static constexpr Duration kLoneAfter = std::chrono::milliseconds(250);
  static constexpr std::size_t kMaxUncommitted = 128;  ///< [frames] Whose arrival is remembered.
  static constexpr std::size_t kMaxRefusals = 256;  ///< Waiting; more are dropped, it asks again.

  /// Requires: session ≠ 0, never used before for this robot's boot; a valid budget.
  ServerLink(std::uint32_t session, const Hello& hello, std::uint64_t epoch,
             std::size_t carrier_overhead_bytes, MonotonicTime now,
             const BudgetConfig& budget = {});

  /// Evidence of one frame, in the order it stood there: heads and blocks.
  struct Evidence {
    std::uint32_t number = 0;
    std::vector<SubmapHead> heads;
    std::vector<BlockUpdate> blocks;
    /// Of what borrows a sequence in this frame: the submap's own name.
    std::map<std::uint32_t, SubmapId> earlier{};

    /// The submap that a sequence of this frame names. `boot`: the session's.
    [[nodiscard]] SubmapId submap(std::uint64_t boot, std::uint32_t sequence) const;
  };
  using Event = std::variant<PoseReport, SpoolReport, CommandReport, CorridorRequest, MapDigest,
                             Evidence, Bye>;
  /// [submaps] Of earlier boots, whose borrowed names are remembered; the lowest goes first.
  static constexpr std::size_t kMaxBorrowed = 1024;

  /// Takes an already decoded frame of this session and reads its patches; evidence of which a
  /// patch cannot be read brings no event and is never acknowledged. A frame that was seen before
  /// brings no event (its acknowledgement is repeated). Frames without evidence are acknowledged at
  /// once. Poses older than the newest and reports overtaken by newer ones bring no event either.
  /// Requires: the frame is of this session.
  std::vector<Event> on_frame(const Frame& frame, std::size_t size_bytes, MonotonicTime now);
  /// Everything in that frame is in the store.
  void durable(std::uint32_t number);
  /// A block of a frame was built on more than is held. The owner never calls `durable` for that
  /// frame: its other contents come again.
  void refuse(const Refusal& refusal);
  /// Asks for a Welcome to be (re)sent: the robot said Hello again in this session.
  void welcome_again();

  /// The command to be carried out now; replaces the one before. Sent, and resent with fresh
  /// times, until the robot reports on this id and revision. `expires_in` is counted from `now` and
  /// translated into the robot's clock from its newest stamp, so that delay shortens it, never
  /// lengthens it. Requires: path.size() ≤ kMaxPathBytes.
  void command(Command command, const std::vector<std::uint8_t>& path, Duration expires_in,
               MonotonicTime now);
  /// A corridor of that command's revision; it is sent after the command, before the map.
  void corridor(CorridorPart part);

  /// The long-term map on its way to the robot; of this session.
  [[nodiscard]] MapSender& map() { return map_; }
  [[nodiscard]] const MapSender& map() const { return map_; }

  std::optional<std::vector<std::uint8_t>> next_frame(MonotonicTime now);
  [[nodiscard]] MonotonicTime next_due(MonotonicTime now) const;

  [[nodiscard]] std::uint32_t session() const { return welcome_.session; }
  [[nodiscard]] const std::string& robot() const { return robot_; }
  [[nodiscard]] std::uint64_t boot() const { return welcome_.boot; }
  /// Time since the last frame of this session (or the Hello that began it).
  [[nodiscard]] Duration silence(MonotonicTime now) const { return now - heard_at_; }
  [[nodiscard]] const LinkCounters& counters() const { return counters_; }
  [[nodiscard]] std::optional<Duration> round_trip() const;
  [[nodiscard]] const Budget& budget() const { return budget_; }
  /// [bytes] Sent and not acknowledged yet.
  [[nodiscard]] std::size_t bytes_under_way() const { return flight_.bytes_under_way(); }

 private:
  struct Stamp {
    std::uint64_t clock_ms = 0;  ///< The robot's clock …
    MonotonicTime at{};          ///< … was already past it at this time of ours.
  };

  struct Heard {
    CommandReport report;
    std::uint32_t number = 0;  ///< Frame it came in.
  };

  void on_ack(const Ack& ack, MonotonicTime now);
  [[nodiscard]] bool read_patches(const Frame& frame, std::vector<BlockUpdate>& blocks);
  /// False when something borrows a sequence that nobody named.
  [[nodiscard]] bool name_earlier(Evidence& evidence);
  bool take(const PoseReport& pose, MonotonicTime now);
  bool take(const CommandReport& report, std::uint32_t number);
  void acknowledge_by(MonotonicTime due);
  void count(const Frame& frame, std::size_t bytes);
  [[nodiscard]] std::uint64_t in_robot_clock(MonotonicTime time) const;
  [[nodiscard]] bool something_is_due(MonotonicTime now) const;
  /// Corridors count as map: nobody waits for them, most robots never need them.
  [[nodiscard]] bool map_waits() const {
    return (corridors_.has_news() || map_.has_news()) && flight_.evidence_may_go();
  }
  [[nodiscard]] bool map_may_go(MonotonicTime now) const;
  /// The parts of a path, and refusals: paced, but before the map.
  [[nodiscard]] bool detail_waits() const {
    return orders_.has_news() || !refusals_.empty() || ground_lost_;
  }
  [[nodiscard]] bool detail_may_go(MonotonicTime now) const;
  void give_up_late_frames(MonotonicTime now);
  std::vector<std::uint8_t> session_frame(MonotonicTime now);
  /// `eliciting`: what kind of frame under way it is, if it asks for an acknowledgement.
  std::vector<std::uint8_t> finish(FrameWriter&& frame, Traffic kind,
                                   std::optional<Flight::Load> eliciting, MonotonicTime now);
  void add_refusals(FrameWriter& frame);
  void lost(const std::vector<std::uint32_t>& numbers);

  Welcome welcome_;
  std::string robot_;
  std::size_t overhead_bytes_;
  bool welcome_due_ = true;
  Flight flight_;
  Budget budget_;
  AckLog received_;
  AckLog done_;
  std::optional<MonotonicTime> ack_due_;
  /// Of frames with evidence that is not durable yet. [Limit: ≤ kMaxUncommitted]
  std::map<std::uint32_t, MonotonicTime> arrived_;
  std::optional<MonotonicTime> evidence_at_;  ///< Arrived last.
  bool lone_ = false;                         ///< It had none shortly before it.
  int durable_unacked_ = 0;                   ///< [frames] Since the last acknowledgement.
  std::uint32_t highest_number_ = 0;
  MonotonicTime heard_at_;

  Stamp stamp_;
  std::uint64_t newest_pose_ms_ = 0;
  OrderSender orders_;
  CorridorSender corridors_;
  MapSender map_;
  PatchReceiver patches_;
  std::optional<GroundLost> ground_lost_;       ///< To be said.
  std::map<std::uint32_t, SubmapId> borrowed_;  ///< In this session. [Limit: ≤ kMaxBorrowed]
  std::deque<Heard> heard_;        ///< Newest report of each revision. [Limit: ≤ kMaxReports]
  std::vector<Refusal> refusals_;  ///< [Limit: ≤ kMaxRefusals]
  LinkCounters counters_;
};

/// What the receiver of a block does with an update, given the version it holds.
enum class Verdict : std::uint8_t {
  apply,   ///< base ≤ held < version
  stale,   ///< held ≥ version: already there, acknowledge.
  refuse,  ///< held < base: ask from `held` on.
};
[[nodiscard]] Verdict judge(std::uint32_t held, std::uint32_t base, std::uint32_t version);

}  // namespace cairn::proto
