#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/common/time.h"
#include "proto/codec/frame.h"
#include "proto/codec/records.h"
#include "proto/sync/transit.h"

namespace cairn::proto {

/// The server's half of a command: its record and the parts of its path, each sent until
/// acknowledged, and the record asked about again until the robot reports on it.
class OrderSender {
 public:
  static constexpr Duration kFirstAskWait = std::chrono::seconds(1);
  static constexpr Duration kMostAskWait = std::chrono::seconds(30);

  /// [bytes] A path up to here travels with its record, in one short frame.
  static constexpr std::size_t kShortPath = 160;

  /// Replaces what was being sent. `path`: coded; what that means is not looked at.
  /// Requires: path.size() ≤ kMaxPathBytes.
  void set(Command command, const std::vector<std::uint8_t>& path, MonotonicTime expires_at);
  /// The robot spoke of the command: nothing of it need be sent any more.
  void on_report(const CommandReport& report);

  /// Sends the record again when everything is there but no report came.
  void ask_again_if_due(MonotonicTime now);
  [[nodiscard]] std::optional<MonotonicTime> ask_due() const;

  [[nodiscard]] bool has_news() const;
  /// Of `has_news`: it is the record, which goes before its parts.
  [[nodiscard]] bool record_waits() const { return command_ && record_.waits(); }
  [[nodiscard]] MonotonicTime expires_at() const { return expires_at_; }
  /// Each returns whether it added something. With the record goes a short path that waits.
  bool fill_command(FrameWriter& frame, std::uint32_t number, std::uint64_t expires_clock_ms,
                    MonotonicTime now);
  bool fill_parts(FrameWriter& frame, std::uint32_t number);
  void on_acked(std::uint32_t number);
  void on_lost(std::uint32_t number);

 private:
  struct Part {
    PathPart part;
    Transit transit = {};
  };

  [[nodiscard]] bool all_acknowledged() const;

  std::optional<Command> command_;  ///< nullopt: none, or the robot reported on it.
  Transit record_;
  std::vector<Part> parts_;  ///< [Limit: ≤ kMaxPathParts]
  MonotonicTime expires_at_{};
  MonotonicTime asked_at_{};
  Duration ask_wait_ = kFirstAskWait;
};

}  // namespace cairn::proto
