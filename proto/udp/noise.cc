#include "proto/udp/noise.h"

#include <string_view>

namespace cairn::proto {
namespace {

static_assert(crypto_scalarmult_BYTES == Secret::kBytes);
static_assert(crypto_aead_chacha20poly1305_ietf_ABYTES == NoiseHandshake::kTagBytes);

constexpr std::string_view kName = "Noise_NNpsk0_25519_ChaChaPoly_SHA256";

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// HMAC-SHA256 over the parts in their order.
Secret hmac(const Secret& key, std::span<const std::uint8_t> first,
            std::span<const std::uint8_t> second = {}) {
  crypto_auth_hmacsha256_state state;
  crypto_auth_hmacsha256_init(&state, key.data(), Secret::kBytes);
  crypto_auth_hmacsha256_update(&state, first.data(), first.size());
  crypto_auth_hmacsha256_update(&state, second.data(), second.size());
  Secret out;
  crypto_auth_hmacsha256_final(&state, out.data());
  return out;
}

/// The framework's HKDF (section 4.3); two outputs are the first two of three.
struct Derived {
  Secret first;
  Secret second;
  Secret third;
};

Derived derive(const Secret& chaining, std::span<const std::uint8_t> input) {
  constexpr std::array<std::uint8_t, 3> kCounts{1, 2, 3};
  const std::span<const std::uint8_t> counts(kCounts);
  const Secret temporary = hmac(chaining, input);
  Derived out;
  out.first = hmac(temporary, counts.subspan(0, 1));
  out.second = hmac(temporary, out.first.bytes(), counts.subspan(1, 1));
  out.third = hmac(temporary, out.second.bytes(), counts.subspan(2, 1));
  return out;
}

/// Every key of this pattern seals one message only, so the nonce is always the first.
constexpr std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES> kFirstNonce{};

}  // namespace

NoiseHandshake::NoiseHandshake(const Secret& key, std::span<const std::uint8_t> prologue,
                               const Secret& ephemeral)
    : ephemeral_(ephemeral) {
  static_assert(kName.size() > Secret::kBytes, "a longer name is hashed, a shorter one padded");
  crypto_hash_sha256(hash_.data(), bytes_of(kName).data(), kName.size());
  chaining_ = hash_;
  mix_hash(prologue);
  mix_key_and_hash(key);
}

void NoiseHandshake::mix_hash(std::span<const std::uint8_t> data) {
  crypto_hash_sha256_state state;
  crypto_hash_sha256_init(&state);
  crypto_hash_sha256_update(&state, hash_.data(), Secret::kBytes);
  crypto_hash_sha256_update(&state, data.data(), data.size());
  crypto_hash_sha256_final(&state, hash_.data());
}

void NoiseHandshake::mix_key(std::span<const std::uint8_t> input) {
  const Derived derived = derive(chaining_, input);
  chaining_ = derived.first;
  cipher_ = derived.second;
}

void NoiseHandshake::mix_key_and_hash(const Secret& key) {
  const Derived derived = derive(chaining_, key.bytes());
  chaining_ = derived.first;
  mix_hash(derived.second.bytes());
  cipher_ = derived.third;
}

bool NoiseHandshake::mix_shared_point() {
  Secret shared;
  if (crypto_scalarmult(shared.data(), ephemeral_.data(), peer_point_.data()) != 0) return false;
  mix_key(shared.bytes());
  return true;
}

void NoiseHandshake::append_own_point(Bytes& message) {
  std::array<std::uint8_t, Secret::kBytes> point{};
  crypto_scalarmult_base(point.data(), ephemeral_.data());
  message.insert(message.end(), point.begin(), point.end());
  mix_hash(point);
  mix_key(point);  // As every pattern with a pre-shared key does (section 9.2).
}

void NoiseHandshake::encrypt(std::span<const std::uint8_t> payload, Bytes& message) {
  Bytes sealed(payload.size() + kTagBytes);
  crypto_aead_chacha20poly1305_ietf_encrypt(sealed.data(), nullptr, payload.data(), payload.size(),
                                            hash_.data(), Secret::kBytes, nullptr,
                                            kFirstNonce.data(), cipher_.data());
  mix_hash(sealed);
  message.insert(message.end(), sealed.begin(), sealed.end());
}

std::optional<NoiseHandshake::Bytes> NoiseHandshake::decrypt(std::span<const std::uint8_t> sealed) {
  if (sealed.size() < kTagBytes) return std::nullopt;
  Bytes payload(sealed.size() - kTagBytes);
  if (crypto_aead_chacha20poly1305_ietf_decrypt(payload.data(), nullptr, nullptr, sealed.data(),
                                                sealed.size(), hash_.data(), Secret::kBytes,
                                                kFirstNonce.data(), cipher_.data()) != 0) {
    return std::nullopt;
  }
  mix_hash(sealed);
  return payload;
}

std::optional<NoiseHandshake::Bytes> NoiseHandshake::read(std::span<const std::uint8_t> message,
                                                          bool shared) {
  if (message.size() < kMessageBytes) return std::nullopt;
  const auto point = message.first<Secret::kBytes>();
  std::copy(point.begin(), point.end(), peer_point_.begin());
  mix_hash(point);
  mix_key(point);
  if (shared && !mix_shared_point()) return std::nullopt;
  return decrypt(message.subspan(Secret::kBytes));
}

NoiseHandshake::Bytes NoiseHandshake::write_first(std::span<const std::uint8_t> payload) {
  Bytes message;
  append_own_point(message);
  encrypt(payload, message);
  return message;
}

std::optional<NoiseHandshake::Bytes> NoiseHandshake::read_first(
    std::span<const std::uint8_t> message) {
  return read(message, false);
}

std::optional<NoiseHandshake::Bytes> NoiseHandshake::write_second(
    std::span<const std::uint8_t> payload) {
  Bytes message;
  append_own_point(message);
  if (!mix_shared_point()) return std::nullopt;
  encrypt(payload, message);
  return message;
}

std::optional<NoiseHandshake::Bytes> NoiseHandshake::read_second(
    std::span<const std::uint8_t> message) {
  return read(message, true);
}

NoiseHandshake::Keys NoiseHandshake::split() const {
  const Derived derived = derive(chaining_, {});
  return {derived.first, derived.second};
}

NoiseHandshake::Proof NoiseHandshake::proof(std::span<const std::uint8_t> said) const {
  const Secret whole = hmac(chaining_, bytes_of("cairn proof"), said);
  Proof proof{};
  std::copy_n(whole.data(), proof.size(), proof.begin());
  return proof;
}

}  // namespace cairn::proto
