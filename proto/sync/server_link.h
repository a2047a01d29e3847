#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/common/time.h"
#include "proto/codec/frame.h"
#include "proto/sync/robot_link.h"

namespace cairn::proto {

/// The server's end of one robot's session, as a state machine without clock, thread or socket.
/// Evidence is handed up frame by frame; the owner commits it and then says `durable(number)`.
class ServerLink {
 public:
  ServerLink(std::uint32_t session, const Hello& hello, std::uint64_t epoch,
             std::size_t carrier_overhead_bytes, MonotonicTime now);

  /// Evidence of one frame, in the order it stood there: heads and blocks.
  struct Evidence {
    std::uint32_t number = 0;
    std::vector<SubmapHead> heads;
    std::vector<BlockUpdate> blocks;
  };
  using Event = std::variant<PoseReport, CommandReport, Evidence, Bye>;

  /// Takes an already decoded frame of this session. A frame that was seen before brings no event
  /// (its acknowledgement is repeated). Frames without evidence are acknowledged at once.
  std::vector<Event> on_frame(const Frame& frame, std::size_t size_bytes, MonotonicTime now);
  /// Everything in that frame is in the store.
  void durable(std::uint32_t number);
  void refuse(const Refusal& refusal);
  /// Asks for a Welcome to be (re)sent: the robot said Hello again in this session.
  void welcome_again();

  /// The command to be carried out now; replaces the one before. Sent, and resent with fresh
  /// times, until the robot reports on this id and revision. `expires_in` is counted from `now` and
  /// translated into the robot's clock from its newest stamp, so that delay shortens it, never
  /// lengthens it.
  void command(Command command, std::vector<PathPart::Point> path, Duration expires_in,
               MonotonicTime now);

  std::optional<std::vector<std::uint8_t>> next_frame(MonotonicTime now);
  [[nodiscard]] MonotonicTime next_due(MonotonicTime now) const;

  [[nodiscard]] std::uint32_t session() const;
  [[nodiscard]] const std::string& robot() const;
  [[nodiscard]] std::uint64_t boot() const;
  [[nodiscard]] Duration silence(MonotonicTime now) const;
  [[nodiscard]] const LinkCounters& counters() const;
  [[nodiscard]] std::optional<Duration> round_trip() const;

 private:
  // Filled in by the implementation.
};

/// What the receiver of a block does with an update, given the version it holds.
enum class Verdict : std::uint8_t {
  apply,   ///< base ≤ held < version
  stale,   ///< held ≥ version: already there, acknowledge.
  refuse,  ///< held < base: ask from `held` on.
};
[[nodiscard]] Verdict judge(std::uint32_t held, std::uint32_t base, std::uint32_t version);

}  // namespace cairn::proto
