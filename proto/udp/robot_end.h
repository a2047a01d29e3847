#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include "core/common/result.h"
#include "core/common/time.h"
#include "proto/udp/noise.h"
#include "proto/udp/packet.h"
#include "proto/udp/session.h"

namespace cairn::proto {

/// A robot's end of the UDP carrier, as a state machine without clock or socket: frames and packets
/// come in, packets and frames go out. It sets up a session when something is to be sent and there
/// is none, when the server says that it does not know the session, when a greeting is to be sent
/// after silence, and once in kMaxAge.
class UdpRobotEnd {
 public:
  /// Wait for an answer before any round trip was measured; grows by half with each try.
  static constexpr Duration kFirstWait = std::chrono::seconds(1);
  static constexpr Duration kLeastWait = std::chrono::milliseconds(250);
  static constexpr Duration kMostWait = std::chrono::seconds(3);
  /// After this long without an answer, tries come less often, so that an empty air stays cheap.
  static constexpr Duration kHopeful = std::chrono::minutes(2);
  static constexpr Duration kPatientWait = std::chrono::seconds(15);
  /// The server's "unknown session" is not proven: it is followed this often at most, and then half
  /// as often each time, up to a minute.
  static constexpr Duration kFirstHintWait = std::chrono::seconds(1);
  static constexpr Duration kMostHintWait = std::chrono::minutes(1);
  /// A greeting after this much silence goes with a new handshake.
  static constexpr Duration kQuiet = std::chrono::seconds(2);
  /// A session that was set up shows the server its keys within this time.
  static constexpr Duration kConfirmWait = std::chrono::milliseconds(100);
  /// Forward secrecy reaches back this far.
  static constexpr Duration kMaxAge = std::chrono::hours(12);
  /// [packets] To the wire; more are dropped, the oldest first.
  static constexpr std::size_t kMaxQueued = 256;

  /// `first_stamp`: greater than those of earlier runs if the robot can know; wall time in
  /// milliseconds is a good one.
  UdpRobotEnd(const Secret& key, std::uint64_t first_stamp);

  /// unavailable while a session is being set up (a greeting goes with the set-up itself).
  Status send(std::span<const std::uint8_t> frame, MonotonicTime now);
  /// The frame that the packet brought, if any. What is not authentic changes nothing.
  std::optional<UdpBytes> on_packet(std::span<const std::uint8_t> packet, MonotonicTime now);
  /// The next packet for the server. Call until nullopt.
  std::optional<UdpBytes> next_packet(MonotonicTime now);
  /// When `next_packet` should be asked again even if nothing happens.
  [[nodiscard]] MonotonicTime next_due(MonotonicTime now) const;

  [[nodiscard]] bool has_session() const { return current_.has_value(); }
  /// Packets that were not authentic, or of no session of ours.
  [[nodiscard]] std::uint64_t refused_packets() const { return refused_; }
  /// Tries of the present set-up so far; 0 when there is none.
  [[nodiscard]] int tries() const { return attempt_ ? attempt_->tries : 0; }

 private:
  /// Why a session is being set up.
  enum class Cause { need, hint, age };
  struct Attempt {
    Cause cause = Cause::need;
    std::uint32_t session = 0;
    UdpBytes greeting;
    NoiseHandshake handshake;
    UdpBytes packet;
    MonotonicTime begun{};
    MonotonicTime due{};
    Duration wait{};
    int tries = 0;
  };

  void begin(Cause cause, UdpBytes greeting, MonotonicTime now);
  std::optional<UdpBytes> on_second(std::span<const std::uint8_t> packet, MonotonicTime now);
  void on_stale(std::span<const std::uint8_t> packet, MonotonicTime now);
  void on_unknown(std::span<const std::uint8_t> packet, MonotonicTime now);
  std::optional<UdpBytes> on_data(std::span<const std::uint8_t> packet, MonotonicTime now);
  std::optional<UdpBytes> refuse();
  void transmit_attempt(MonotonicTime now);
  void queue(UdpBytes packet);

  Secret key_;
  KeyId key_id_;
  std::uint32_t agent_;
  std::uint64_t next_stamp_;
  std::optional<UdpSession> current_;
  std::optional<UdpSession> previous_;  ///< Still listened to: packets overtake each other.
  std::optional<Attempt> attempt_;
  std::optional<Duration> round_trip_;
  MonotonicTime session_begun_{};
  MonotonicTime heard_at_{};
  std::optional<MonotonicTime> confirm_due_;
  MonotonicTime hint_from_{};
  Duration hint_wait_ = kFirstHintWait;
  std::deque<UdpBytes> outbox_;  ///< [Limit: ≤ kMaxQueued]
  std::uint64_t refused_ = 0;
};

}  // namespace cairn::proto
