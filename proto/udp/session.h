#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "proto/udp/packet.h"
#include "proto/udp/replay_window.h"
#include "proto/udp/secret.h"

namespace cairn::proto {

/// Keys of a finished handshake: seals frames into data packets and opens the peer's
/// (ChaCha20-Poly1305, RFC 8439; the counter is the nonce, the head is authenticated too).
class UdpSession {
 public:
  /// `own`, `peer`: the names that either end is called by.
  UdpSession(std::uint32_t own, std::uint32_t peer, const Secret& sending, const Secret& receiving)
      : own_(own), peer_(peer), sending_(sending), receiving_(receiving) {}

  [[nodiscard]] UdpBytes seal(std::span<const std::uint8_t> frame);

  struct Opened {
    UdpBytes frame;  ///< Empty: the packet only shows that its sender has the keys.
    bool newest = false;
  };
  /// Nullopt for what is forged, damaged, not for this session, or was here before.
  [[nodiscard]] std::optional<Opened> open(std::span<const std::uint8_t> packet);

  [[nodiscard]] std::uint32_t own() const { return own_; }
  [[nodiscard]] std::uint32_t peer() const { return peer_; }

 private:
  std::uint32_t own_;
  std::uint32_t peer_;
  Secret sending_;
  Secret receiving_;
  std::uint64_t next_counter_ = 0;  ///< 2^64 packets are never reached.
  ReplayWindow window_;
};

}  // namespace cairn::proto
