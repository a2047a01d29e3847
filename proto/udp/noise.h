#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "proto/udp/secret.h"

namespace cairn::proto {

/// One end of the handshake Noise_NNpsk0_25519_ChaChaPoly_SHA256 (The Noise Protocol Framework,
/// revision 34): a pre-shared key proves who the ends are, fresh X25519 keys give keys that the
/// pre-shared one cannot recover later. The initiator writes the first and reads the second
/// message, the responder the other way round; then both split. A copy is an independent handshake
/// at the same point, so that a forged message can be tried on one.
class NoiseHandshake {
 public:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr std::size_t kTagBytes = 16;
  /// [bytes] What a message costs beyond its payload.
  static constexpr std::size_t kMessageBytes = Secret::kBytes + kTagBytes;

  /// `prologue`: public bytes that both ends must agree on. `ephemeral`: random, used once.
  NoiseHandshake(const Secret& key, std::span<const std::uint8_t> prologue,
                 const Secret& ephemeral);

  /// → psk, e
  [[nodiscard]] Bytes write_first(std::span<const std::uint8_t> payload);
  /// The payload; nullopt when whoever wrote it does not know the key.
  [[nodiscard]] std::optional<Bytes> read_first(std::span<const std::uint8_t> message);
  /// ← e, ee; nullopt when the initiator's public key is a degenerate one.
  [[nodiscard]] std::optional<Bytes> write_second(std::span<const std::uint8_t> payload);
  [[nodiscard]] std::optional<Bytes> read_second(std::span<const std::uint8_t> message);

  struct Keys {
    Secret from_initiator;
    Secret from_responder;
  };
  /// The session's keys. Requires: the second message was written or read.
  [[nodiscard]] Keys split() const;

  using Proof = std::array<std::uint8_t, 16>;
  /// Shows knowledge of the handshake up to this point, and binds `said` to it.
  [[nodiscard]] Proof proof(std::span<const std::uint8_t> said) const;

 private:
  void mix_hash(std::span<const std::uint8_t> data);
  void mix_key(std::span<const std::uint8_t> input);
  void mix_key_and_hash(const Secret& key);
  [[nodiscard]] bool mix_shared_point();
  void append_own_point(Bytes& message);
  void encrypt(std::span<const std::uint8_t> payload, Bytes& message);
  [[nodiscard]] std::optional<Bytes> read(std::span<const std::uint8_t> message, bool shared);
  [[nodiscard]] std::optional<Bytes> decrypt(std::span<const std::uint8_t> sealed);

  Secret chaining_;
  Secret hash_;  ///< Public, but of the same size.
  Secret cipher_;
  Secret ephemeral_;
  std::array<std::uint8_t, Secret::kBytes> peer_point_{};
};

}  // namespace cairn::proto
