#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "proto/udp/noise.h"

/// The layouts of datagrams (PROTOCOL.md, "Over UDP").
namespace cairn::proto {

using UdpBytes = std::vector<std::uint8_t>;
using KeyId = std::array<std::uint8_t, 8>;

inline constexpr std::uint8_t kUdpVersion = 1;

enum class PacketType : std::uint8_t {
  first = 1,
  second = 2,
  stale = 3,
  unknown = 4,
  data = 5,
  data_up = 6,    ///< A robot's frame without its ends (see bare_frame).
  data_down = 7,  ///< A server's.
};

inline constexpr std::size_t kFirstHeadBytes = 2 + sizeof(KeyId);
inline constexpr std::size_t kSecondHeadBytes = 1 + 4;
inline constexpr std::size_t kDataHeadBytes = 1 + 4 + 3;
/// [bytes] A data packet beyond its frame.
inline constexpr std::size_t kDataBytes = kDataHeadBytes + NoiseHandshake::kTagBytes;

/// Nullopt for what is empty or of no known type.
[[nodiscard]] std::optional<PacketType> packet_type(std::span<const std::uint8_t> packet);

/// The head of a first message; also the handshake's prologue.
[[nodiscard]] UdpBytes first_head(const KeyId& key);
/// What stands in a first message under the key.
struct FirstPayload {
  std::uint64_t stamp = 0;    ///< Greater than any this robot used before.
  std::uint32_t session = 0;  ///< Name that the robot wants to be called by.
  std::uint32_t agent =
      0;              ///< The same in all set-ups of a running agent, by chance unlike others.
  UdpBytes greeting;  ///< A frame outside of any session, or nothing.
};
[[nodiscard]] UdpBytes encode(const FirstPayload& payload);
[[nodiscard]] std::optional<FirstPayload> decode_first_payload(std::span<const std::uint8_t> bytes);

/// The session that a packet of the types `second`, `stale`, `unknown` or `data` names; nullopt
/// when it is too short for its type.
[[nodiscard]] std::optional<std::uint32_t> named_session(std::span<const std::uint8_t> packet);

[[nodiscard]] UdpBytes second_head(std::uint32_t robot_session);
struct SecondPayload {
  std::uint32_t session = 0;  ///< Name that the server wants to be called by.
  UdpBytes answer;            ///< A frame, or nothing.
};
[[nodiscard]] UdpBytes encode(const SecondPayload& payload);
[[nodiscard]] std::optional<SecondPayload> decode_second_payload(
    std::span<const std::uint8_t> bytes);

struct Stale {
  std::uint32_t robot_session = 0;
  std::uint64_t newest = 0;  ///< Stamp that the server has seen.
  NoiseHandshake::Proof proof{};
};
[[nodiscard]] UdpBytes encode(const Stale& stale);
[[nodiscard]] std::optional<Stale> decode_stale(std::span<const std::uint8_t> packet);
/// What of a stale answer the proof covers.
[[nodiscard]] UdpBytes stale_said(std::uint64_t newest);

[[nodiscard]] UdpBytes unknown_packet(std::uint32_t session);

/// Of one of the types of data.
[[nodiscard]] UdpBytes data_head(std::uint32_t session, std::uint64_t counter,
                                 PacketType type = PacketType::data);
[[nodiscard]] bool is_data(std::span<const std::uint8_t> packet);

/// A frame that belongs to no session of the layer above: it only says who is there. Nothing else
/// may travel before keys with forward secrecy are agreed.
[[nodiscard]] bool is_greeting(std::span<const std::uint8_t> frame);

}  // namespace cairn::proto
