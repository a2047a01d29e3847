#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/common/time.h"
#include "proto/codec/frame.h"
#include "proto/sync/evidence_sender.h"

namespace cairn::proto {

struct RobotLinkConfig {
  std::string robot;
  std::string site;
  std::uint64_t boot = 0;
  int cell_size_mm = 125;
  /// [frames] Evidence frames under way at once.
  int window_frames = 48;
  /// [ms] How often a pose is sent.
  Duration pose_period = std::chrono::milliseconds(500);
  /// How long `robot_id_in_use` is retried before it is final (an agent that was killed a moment
  /// ago still counts as present at the server).
  Duration in_use_patience = std::chrono::seconds(12);
};

/// Counters of one end of a link; bytes include the carrier's overhead.
struct LinkCounters {
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t bytes_received = 0;
  std::uint64_t frames_lost = 0;       ///< Sent and judged lost.
  std::uint64_t frames_malformed = 0;  ///< Received and refused by the decoder.
};

/// The robot's end of the link as a state machine without clock, thread or socket: bytes and the
/// time come in, bytes go out. Priorities within a frame: acknowledgement and command reports,
/// pose, evidence.
class RobotLink {
 public:
  RobotLink(RobotLinkConfig config, std::size_t carrier_overhead_bytes);

  EvidenceSender& evidence() { return evidence_; }
  const EvidenceSender& evidence() const { return evidence_; }
  void set_pose(const PoseReport& pose);
  void report(const CommandReport& report);

  /// A command that is new or has a new revision, with its whole path (all parts arrived).
  struct Order {
    Command command;
    std::vector<PathPart::Point> path;
  };
  /// What a frame brought. A malformed frame is counted and brings nothing.
  std::vector<Order> on_frame(std::span<const std::uint8_t> bytes, MonotonicTime now);
  /// The next frame to send now; nullopt when nothing is due. Call until nullopt.
  std::optional<std::vector<std::uint8_t>> next_frame(MonotonicTime now);
  /// When `next_frame` should be asked again even if nothing arrives.
  [[nodiscard]] MonotonicTime next_due(MonotonicTime now) const;
  /// The frame that ends the session in good order.
  std::optional<std::vector<std::uint8_t>> goodbye();

  [[nodiscard]] bool connected() const;
  /// Time since the last valid frame from the server; nullopt before the first.
  [[nodiscard]] std::optional<Duration> silence(MonotonicTime now) const;
  /// Set when the server refused this robot for good; the message says what to do.
  [[nodiscard]] const std::optional<Error>& rejected() const;
  [[nodiscard]] const LinkCounters& counters() const;
  [[nodiscard]] std::optional<Duration> round_trip() const;

 private:
  EvidenceSender evidence_;
  // Filled in by the implementation.
};

}  // namespace cairn::proto
