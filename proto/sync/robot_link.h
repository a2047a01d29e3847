#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/common/time.h"
#include "proto/codec/frame.h"
#include "proto/sync/ack_log.h"
#include "proto/sync/budget.h"
#include "proto/sync/digest_sender.h"
#include "proto/sync/evidence_sender.h"
#include "proto/sync/flight.h"
#include "proto/sync/map_inbox.h"
#include "proto/sync/order_desk.h"
#include "proto/sync/report_board.h"
#include "proto/sync/transit.h"

namespace cairn::proto {

struct RobotLinkConfig {
  std::string robot;
  std::string site;
  std::uint64_t boot = 0;
  int cell_size_mm = 125;
  BudgetConfig budget = {};
  /// How often a pose is sent …
  Duration pose_period = std::chrono::seconds(1);
  /// … and how often one that says nothing new (the robot stands), so that the server knows that
  /// the robot is there.
  Duration quiet_pose_period = std::chrono::seconds(20);
  /// A pose takes the state of the spool along when it was told longer ago than this.
  Duration spool_period = std::chrono::seconds(5);
  /// How often evidence sets out: what changed meanwhile travels once. While a round is not yet all
  /// sent (a slow link, a full window) it goes on.
  Duration evidence_period = std::chrono::seconds(1);
  /// How often some of what the robot holds of the long-term map is compared with the server's.
  Duration digest_period = std::chrono::minutes(5);
  /// How long `robot_id_in_use` is retried before it is final (an agent that was killed a moment
  /// ago still counts as present at the server).
  Duration in_use_patience = std::chrono::seconds(30);
};

/// Counters of one end of a link; bytes include the carrier's overhead.
struct LinkCounters {
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t bytes_received = 0;
  std::uint64_t frames_lost = 0;       ///< Sent and judged lost, less those found again.
  std::uint64_t frames_missed = 0;     ///< Of the peer's numbers: never came.
  TrafficBytes received_bytes{};       ///< Of `bytes_received`, by kind.
  std::uint64_t frames_malformed = 0;  ///< Received and refused by the decoder.
};

/// The robot's end of the link as a state machine without clock, thread or socket: bytes and the
/// time come in, bytes go out. `now` is the robot's monotonic clock, the same that stamps its
/// poses. Priorities within a frame: acknowledgement and command reports, pose, evidence.
class RobotLink {
 public:
  /// Silence from the server, with something unanswered, after which the robot says Hello again.
  static constexpr Duration kSilence = std::chrono::seconds(15);
  /// A robot under way that heard nothing for so long asks for an acknowledgement with each pose.
  static constexpr Duration kAsksAfter = std::chrono::milliseconds(1800);
  static constexpr Duration kFirstHelloWait = std::chrono::milliseconds(300);
  static constexpr Duration kMostHelloWait = std::chrono::seconds(3);
  /// An acknowledgement waits this long for something to travel with …
  static constexpr Duration kAckDelay = std::chrono::milliseconds(25);
  /// … and one of map this long for more to acknowledge, of which there are at most so many.
  static constexpr Duration kMapAckDelay = std::chrono::milliseconds(100);
  static constexpr int kMostMapUnacked = 8;
  /// `next_due` when nothing at all is under way or planned.
  static constexpr Duration kNothingDue = std::chrono::hours(1);
  static constexpr std::size_t kMaxLeftSessions = 16;  ///< Remembered, never entered again.

  /// Requires: robot and site are names (text.h), cell size 10 … 2000 mm, a valid budget.
  RobotLink(RobotLinkConfig config, std::size_t carrier_overhead_bytes);

  EvidenceSender& evidence() { return evidence_; }
  const EvidenceSender& evidence() const { return evidence_; }
  /// Newest pose, sent once at its turn. Requires: within the bounds of its record.
  void set_pose(const PoseReport& pose);
  /// Newest state of the spool; travels with a pose when it is its turn. Never called: no spool.
  void set_spool(const SpoolReport& spool) { spool_ = spool; }
  /// Newest state of a command's revision; saying the same again changes nothing.
  void report(const CommandReport& report);
  /// What the robot lacks; replaces what it asked for before.
  void request(const CorridorRequest& request);

  using Order = proto::Order;
  /// What a frame brought. A malformed frame is counted and brings nothing.
  std::vector<Order> on_frame(std::span<const std::uint8_t> bytes, MonotonicTime now);
  /// What came of the long-term map since this was last asked, in its order. Bounded by the server,
  /// which commits a step only after the one before was acknowledged.
  std::vector<MapUpdate> take_map_updates();
  enum class DigestWish : std::uint8_t { none, some, all };
  /// Of how much of the map that the robot holds the server should have digests now. `tell_digests`
  /// answers it; without evidence under way digests compare best.
  [[nodiscard]] DigestWish digest_wish(MonotonicTime now) const;
  /// To a wish for all: of all that is held, the last one marked so, even if nothing is.
  void tell_digests(std::vector<MapDigest> digests, MonotonicTime now);
  /// What came of the corridor of the order that was handed out last.
  std::vector<CorridorPart> take_corridors() { return orders_.take_corridors(); }
  /// The next frame to send now; nullopt when nothing is due. Call until nullopt.
  std::optional<std::vector<std::uint8_t>> next_frame(MonotonicTime now);
  /// When `next_frame` should be asked again even if nothing arrives.
  [[nodiscard]] MonotonicTime next_due(MonotonicTime now) const;
  /// The frame that ends the session in good order; nullopt without a session.
  std::optional<std::vector<std::uint8_t>> goodbye();

  [[nodiscard]] bool connected() const { return phase_ == Phase::connected; }
  /// Time since the last valid frame of a session from the server; nullopt before the first.
  [[nodiscard]] std::optional<Duration> silence(MonotonicTime now) const;
  /// Set when the server refused this robot for good; the message says what to do.
  [[nodiscard]] const std::optional<Error>& rejected() const { return rejected_; }
  [[nodiscard]] const LinkCounters& counters() const { return counters_; }
  [[nodiscard]] std::optional<Duration> round_trip() const;
  [[nodiscard]] const Budget& budget() const { return budget_; }

 private:
  enum class Phase { hello, connected, rejected };

  void say_hello_from(MonotonicTime now);
  void on_answer(const Record& record, const FrameHeader& header, MonotonicTime now);
  void on_welcome(const Welcome& welcome, MonotonicTime now);
  void on_reject(const Reject& reject, MonotonicTime now);
  void begin_session(const Welcome& welcome);
  void leave_session();
  std::vector<Order> on_session_frame(const Frame& frame, MonotonicTime now);
  /// False when one cannot be read: then the frame is as good as lost.
  bool take_patches(const Frame& frame);
  void take_map(const Record& record);
  void on_ack(const Ack& ack, MonotonicTime now);
  void take(OrderDesk::Outcome outcome, std::vector<Order>& orders);
  void lost(const std::vector<std::uint32_t>& numbers);

  std::optional<std::vector<std::uint8_t>> hello_frame(MonotonicTime now);
  std::optional<std::vector<std::uint8_t>> session_frame(MonotonicTime now);
  [[nodiscard]] bool asks(MonotonicTime now) const;
  void add_spool_if_due(FrameWriter& frame, MonotonicTime now);
  [[nodiscard]] bool silent_too_long(MonotonicTime now) const;
  /// Requires: a pose waits.
  [[nodiscard]] MonotonicTime pose_due(MonotonicTime now) const;
  [[nodiscard]] bool pose_is_due(MonotonicTime now) const;
  [[nodiscard]] bool something_is_due(MonotonicTime now) const;
  [[nodiscard]] bool request_waits() const { return request_ && request_->transit.waits(); }
  [[nodiscard]] bool evidence_waits() const;
  [[nodiscard]] bool evidence_may_go(MonotonicTime now) const;
  [[nodiscard]] bool digests_may_go(MonotonicTime now) const;
  [[nodiscard]] bool digests_wait() const;
  void open_round_if_due(MonotonicTime now);
  [[nodiscard]] MonotonicTime round_due(MonotonicTime now) const;
  void acknowledge_by(MonotonicTime due);
  void give_up_late_frames(MonotonicTime now);
  std::vector<std::uint8_t> finish(FrameWriter&& frame);

  RobotLinkConfig config_;
  std::size_t overhead_bytes_;
  Phase phase_ = Phase::hello;
  std::optional<Error> rejected_;

  std::uint32_t hellos_ = 0;
  std::optional<MonotonicTime> hello_due_;  ///< nullopt: at once.
  Duration hello_wait_ = kFirstHelloWait;
  std::optional<MonotonicTime> in_use_since_;

  std::uint32_t session_ = 0;                ///< 0: none, or the server forgot it.
  std::deque<std::uint32_t> left_sessions_;  ///< [Limit: ≤ kMaxLeftSessions]
  std::optional<std::uint64_t> epoch_;
  Flight flight_;
  Budget budget_;
  AckLog received_;
  std::optional<MonotonicTime> ack_due_;
  int map_unacked_ = 0;  ///< [frames] Of map, since the last acknowledgement.
  std::optional<MonotonicTime> heard_at_;
  std::optional<MonotonicTime> unanswered_since_;

  EvidenceSender evidence_;
  ReportBoard reports_;
  OrderDesk orders_;
  /// Until acknowledged.
  struct Request {
    CorridorRequest record;
    Transit transit = {};
  };
  std::optional<Request> request_;
  MapInbox map_;
  DigestSender digests_;
  std::optional<MonotonicTime> digests_due_;  ///< nullopt: all, at once.
  std::vector<MapUpdate> map_updates_;
  std::optional<PoseReport> pose_;  ///< Not sent yet.
  std::optional<PoseReport> told_;  ///< Sent last in this session.
  MonotonicTime told_at_{};
  std::optional<SpoolReport> spool_;
  std::optional<SpoolReport> spool_told_;       ///< Last.
  std::optional<MonotonicTime> spool_told_at_;  ///< In this session.
  bool round_open_ = false;                     ///< Evidence is being sent.
  MonotonicTime round_due_{};
  LinkCounters counters_;
};

}  // namespace cairn::proto
