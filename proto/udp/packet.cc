#include "proto/udp/packet.h"

#include <algorithm>

#include "proto/codec/bytes.h"
#include "proto/codec/frame.h"

namespace cairn::proto {
namespace {

constexpr std::size_t kStaleBytes = 1 + 4 + 8 + sizeof(NoiseHandshake::Proof);
constexpr std::size_t kUnknownBytes = 1 + 4;

UdpBytes typed(PacketType type) { return {static_cast<std::uint8_t>(type)}; }

/// [bytes] The least of a packet of this type.
std::size_t least_bytes(PacketType type) {
  switch (type) {
    case PacketType::first:
      return kFirstHeadBytes + NoiseHandshake::kMessageBytes;
    case PacketType::second:
      return kSecondHeadBytes + NoiseHandshake::kMessageBytes;
    case PacketType::stale:
      return kStaleBytes;
    case PacketType::unknown:
      return kUnknownBytes;
    case PacketType::data:
    case PacketType::data_up:
    case PacketType::data_down:
      return kDataBytes;
  }
  return 0;
}

UdpBytes rest_of(ByteReader& reader) {
  const auto rest = reader.take(reader.left());
  return {rest.begin(), rest.end()};
}

}  // namespace

std::optional<PacketType> packet_type(std::span<const std::uint8_t> packet) {
  if (packet.empty()) return std::nullopt;
  const auto type = static_cast<PacketType>(packet[0]);
  if (type < PacketType::first || type > PacketType::data_down) return std::nullopt;
  return type;
}

UdpBytes first_head(const KeyId& key) {
  UdpBytes head = typed(PacketType::first);
  ByteWriter writer(head);
  writer.put(kUdpVersion);
  writer.put_bytes(key);
  return head;
}

UdpBytes encode(const FirstPayload& payload) {
  UdpBytes bytes;
  ByteWriter writer(bytes);
  writer.put(payload.stamp);
  writer.put(payload.session);
  writer.put(payload.agent);
  writer.put_bytes(payload.greeting);
  return bytes;
}

std::optional<FirstPayload> decode_first_payload(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  FirstPayload payload;
  payload.stamp = reader.get<std::uint64_t>();
  payload.session = reader.get<std::uint32_t>();
  payload.agent = reader.get<std::uint32_t>();
  if (reader.failed()) return std::nullopt;
  payload.greeting = rest_of(reader);
  return payload;
}

std::optional<std::uint32_t> named_session(std::span<const std::uint8_t> packet) {
  const auto type = packet_type(packet);
  if (!type || *type == PacketType::first || packet.size() < least_bytes(*type)) {
    return std::nullopt;
  }
  ByteReader reader(packet.subspan(1));
  return reader.get<std::uint32_t>();
}

UdpBytes second_head(std::uint32_t robot_session) {
  UdpBytes head = typed(PacketType::second);
  ByteWriter(head).put(robot_session);
  return head;
}

UdpBytes encode(const SecondPayload& payload) {
  UdpBytes bytes;
  ByteWriter writer(bytes);
  writer.put(payload.session);
  writer.put_bytes(payload.answer);
  return bytes;
}

std::optional<SecondPayload> decode_second_payload(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  SecondPayload payload;
  payload.session = reader.get<std::uint32_t>();
  if (reader.failed()) return std::nullopt;
  payload.answer = rest_of(reader);
  return payload;
}

UdpBytes stale_said(std::uint64_t newest) {
  UdpBytes said = typed(PacketType::stale);
  ByteWriter(said).put(newest);
  return said;
}

UdpBytes encode(const Stale& stale) {
  UdpBytes packet = typed(PacketType::stale);
  ByteWriter writer(packet);
  writer.put(stale.robot_session);
  writer.put(stale.newest);
  writer.put_bytes(stale.proof);
  return packet;
}

std::optional<Stale> decode_stale(std::span<const std::uint8_t> packet) {
  if (packet_type(packet) != PacketType::stale || packet.size() != kStaleBytes) return std::nullopt;
  ByteReader reader(packet.subspan(1));
  Stale stale;
  stale.robot_session = reader.get<std::uint32_t>();
  stale.newest = reader.get<std::uint64_t>();
  const auto proof = reader.take(stale.proof.size());
  std::copy(proof.begin(), proof.end(), stale.proof.begin());
  return stale;
}

UdpBytes unknown_packet(std::uint32_t session) {
  UdpBytes packet = typed(PacketType::unknown);
  ByteWriter(packet).put(session);
  return packet;
}

UdpBytes data_head(std::uint32_t session, std::uint64_t counter, PacketType type) {
  UdpBytes head = typed(type);
  ByteWriter writer(head);
  writer.put(session);
  writer.put(static_cast<std::uint16_t>(counter & 0xFFFFU));
  writer.put(static_cast<std::uint8_t>((counter >> 16U) & 0xFFU));
  return head;
}

bool is_data(std::span<const std::uint8_t> packet) {
  return packet_type(packet).value_or(PacketType::first) >= PacketType::data;
}

bool is_greeting(std::span<const std::uint8_t> frame) {
  constexpr std::size_t kSessionAt = 4;
  if (frame.size() < kFrameHeaderBytes + kChecksumBytes || frame.size() > kMaxFrameBytes) {
    return false;
  }
  return std::ranges::all_of(frame.subspan(kSessionAt, 4), [](std::uint8_t b) { return b == 0; });
}

}  // namespace cairn::proto
