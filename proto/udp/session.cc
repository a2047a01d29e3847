#include "proto/udp/session.h"

#include <array>

#include "proto/codec/frame.h"

namespace cairn::proto {
namespace {

using Nonce = std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES>;

Nonce nonce_of(std::uint64_t counter) {
  Nonce nonce{};
  for (std::size_t i = 0; i < 8; ++i) {
    nonce[4 + i] = static_cast<std::uint8_t>(counter >> (8 * i));
  }
  return nonce;
}

std::uint32_t low_counter(std::span<const std::uint8_t> packet) {
  constexpr std::size_t kAt = 5;
  return packet[kAt] | (std::uint32_t{packet[kAt + 1]} << 8U) |
         (std::uint32_t{packet[kAt + 2]} << 16U);
}

struct Content {
  PacketType type;
  std::span<const std::uint8_t> bytes;
};

/// The seal says what a frame's ends say: they stay at home.
Content content_of(std::span<const std::uint8_t> frame) {
  if (const auto up = bare_frame(frame, Direction::up)) return {PacketType::data_up, *up};
  if (const auto down = bare_frame(frame, Direction::down)) return {PacketType::data_down, *down};
  return {PacketType::data, frame};
}

}  // namespace

UdpBytes UdpSession::seal(std::span<const std::uint8_t> frame) {
  const std::uint64_t counter = next_counter_++;
  const Content content = content_of(frame);
  UdpBytes packet = data_head(peer_, counter, content.type);
  packet.resize(kDataBytes + content.bytes.size());
  crypto_aead_chacha20poly1305_ietf_encrypt(
      packet.data() + kDataHeadBytes, nullptr, content.bytes.data(), content.bytes.size(),
      packet.data(), kDataHeadBytes, nullptr, nonce_of(counter).data(), sending_.data());
  return packet;
}

std::optional<UdpSession::Opened> UdpSession::open(std::span<const std::uint8_t> packet) {
  if (!is_data(packet) || named_session(packet) != own_) return std::nullopt;
  const std::uint64_t counter = window_.expand(low_counter(packet));
  if (!window_.is_new(counter)) return std::nullopt;
  Opened opened;
  opened.frame.resize(packet.size() - kDataBytes);
  const auto sealed = packet.subspan(kDataHeadBytes);
  if (crypto_aead_chacha20poly1305_ietf_decrypt(
          opened.frame.data(), nullptr, nullptr, sealed.data(), sealed.size(), packet.data(),
          kDataHeadBytes, nonce_of(counter).data(), receiving_.data()) != 0) {
    return std::nullopt;
  }
  opened.newest = window_.accept(counter);
  const auto type = packet_type(packet);
  if (type == PacketType::data_up) opened.frame = whole_frame(opened.frame, Direction::up);
  if (type == PacketType::data_down) opened.frame = whole_frame(opened.frame, Direction::down);
  return opened;
}

}  // namespace cairn::proto
