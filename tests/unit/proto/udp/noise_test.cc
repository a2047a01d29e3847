#include "proto/udp/noise.h"

#include <gtest/gtest.h>

#include <string>

namespace cairn::proto {
namespace {

using Bytes = NoiseHandshake::Bytes;

Bytes from_hex(const std::string& hex) {
  Bytes bytes(hex.size() / 2);
  std::size_t size = 0;
  sodium_hex2bin(bytes.data(), bytes.size(), hex.data(), hex.size(), nullptr, &size, nullptr);
  bytes.resize(size);
  return bytes;
}

Secret secret(const std::string& hex) {
  const Bytes bytes = from_hex(hex);
  return Secret(std::span<const std::uint8_t, Secret::kBytes>(bytes));
}

Bytes text(const std::string& said) { return {said.begin(), said.end()}; }

/// The published vector of this pattern (cacophony's, which every implementation tests against).
struct Published {
  Secret key = secret("54686973206973206d7920417573747269616e20706572737065637469766521");
  Bytes prologue = from_hex("4a6f686e2047616c74");
  NoiseHandshake initiator{
      key, prologue, secret("893e28b9dc6ca8d611ab664754b8ceb7bac5117349a4439a6b0569da977c464a")};
  NoiseHandshake responder{
      key, prologue, secret("bbdb4cdbd309f1a1f2e1456967fe288cadd6f712d65dc7b7793d5e63da6b375b")};
};

TEST(Noise, SaysWhatThePublishedVectorSays) {
  Published vector;
  const Bytes first = vector.initiator.write_first(from_hex("4c756477696720766f6e204d69736573"));
  EXPECT_EQ(first, from_hex("ca35def5ae56cec33dc2036731ab14896bc4c75dbb07a61f879f8e3afa4c794479b962"
                            "b8aff8485742ac32f905ba45369e2465fb59e138a93d67a0d1266b6a54"));
  ASSERT_EQ(vector.responder.read_first(first), from_hex("4c756477696720766f6e204d69736573"));
  const auto second = vector.responder.write_second(from_hex("4d757272617920526f746862617264"));
  ASSERT_TRUE(second);
  EXPECT_EQ(*second, from_hex("95ebc60d2b1fa672c1f46a8aa265ef51bfe38e7ccb39ec5be34069f144808843d606"
                              "2704d5a9c422a8e834423f8c1feada7e8d0d910a1a2cd030fb584221e3"));
  EXPECT_EQ(vector.initiator.read_second(*second), from_hex("4d757272617920526f746862617264"));
}

TEST(Noise, GivesTheKeysThatOpenThePublishedTransportMessage) {
  Published vector;
  const auto heard = vector.responder.read_first(vector.initiator.write_first(text("Ludwig")));
  ASSERT_TRUE(heard);
  Published again;
  const Bytes first = again.initiator.write_first(from_hex("4c756477696720766f6e204d69736573"));
  ASSERT_TRUE(again.responder.read_first(first));
  const auto second = again.responder.write_second(from_hex("4d757272617920526f746862617264"));
  ASSERT_TRUE(second && again.initiator.read_second(*second));
  const Bytes sealed = from_hex("e632c3763d7669067383433197a3baddf146e9e70ad4b4e9e59e0f");
  Bytes opened(sealed.size() - NoiseHandshake::kTagBytes);
  const std::array<std::uint8_t, 12> nonce{};
  EXPECT_EQ(crypto_aead_chacha20poly1305_ietf_decrypt(
                opened.data(), nullptr, nullptr, sealed.data(), sealed.size(), nullptr, 0,
                nonce.data(), again.initiator.split().from_initiator.data()),
            0);
  EXPECT_EQ(opened, from_hex("462e20412e20486179656b"));
}

struct Ends {
  explicit Ends(const Secret& initiators, const Secret& responders, const Bytes& prologue = {1})
      : initiator(initiators, Bytes{1}, Secret::random()),
        responder(responders, prologue, Secret::random()) {}
  NoiseHandshake initiator;
  NoiseHandshake responder;
};

TEST(Noise, BothEndsAgreeOnKeysThatDifferByDirection) {
  const Secret key = Secret::random();
  Ends ends(key, key);
  ASSERT_TRUE(ends.responder.read_first(ends.initiator.write_first({})));
  const auto second = ends.responder.write_second({});
  ASSERT_TRUE(second && ends.initiator.read_second(*second));
  const auto a = ends.initiator.split();
  const auto b = ends.responder.split();
  EXPECT_TRUE(std::ranges::equal(a.from_initiator.bytes(), b.from_initiator.bytes()));
  EXPECT_TRUE(std::ranges::equal(a.from_responder.bytes(), b.from_responder.bytes()));
  EXPECT_FALSE(std::ranges::equal(a.from_initiator.bytes(), a.from_responder.bytes()));
}

TEST(Noise, RefusesAnotherKey) {
  Ends ends(Secret::random(), Secret::random());
  EXPECT_FALSE(ends.responder.read_first(ends.initiator.write_first(text("let me in"))));
}

TEST(Noise, RefusesAnotherPrologue) {
  const Secret key = Secret::random();
  Ends ends(key, key, {2});
  EXPECT_FALSE(ends.responder.read_first(ends.initiator.write_first({})));
}

TEST(Noise, RefusesEveryFlippedBitOfEitherMessage) {
  const Secret key = Secret::random();
  Ends ends(key, key);
  const Bytes first = ends.initiator.write_first(text("hello"));
  for (std::size_t bit = 0; bit < first.size() * 8; ++bit) {
    Bytes forged = first;
    forged[bit / 8] = static_cast<std::uint8_t>(forged[bit / 8] ^ (1U << (bit % 8)));
    NoiseHandshake trial = ends.responder;
    EXPECT_FALSE(trial.read_first(forged)) << "bit " << bit;
  }
  ASSERT_TRUE(ends.responder.read_first(first));
  const auto second = ends.responder.write_second(text("welcome"));
  ASSERT_TRUE(second);
  for (std::size_t byte = 0; byte < second->size(); ++byte) {
    Bytes forged = *second;
    forged[byte] = static_cast<std::uint8_t>(forged[byte] ^ 1U);
    NoiseHandshake trial = ends.initiator;
    EXPECT_FALSE(trial.read_second(forged)) << "byte " << byte;
  }
  EXPECT_TRUE(ends.initiator.read_second(*second));
}

TEST(Noise, RefusesEveryTruncation) {
  const Secret key = Secret::random();
  Ends ends(key, key);
  const Bytes first = ends.initiator.write_first(text("hello"));
  for (std::size_t size = 0; size < first.size(); ++size) {
    NoiseHandshake trial = ends.responder;
    EXPECT_FALSE(trial.read_first(std::span(first).first(size)));
  }
}

TEST(Noise, ProofsBindWhatWasSaidToTheHandshake) {
  const Secret key = Secret::random();
  Ends ends(key, key);
  ASSERT_TRUE(ends.responder.read_first(ends.initiator.write_first({})));
  EXPECT_EQ(ends.initiator.proof(text("seven")), ends.responder.proof(text("seven")));
  EXPECT_NE(ends.initiator.proof(text("seven")), ends.responder.proof(text("eight")));
  NoiseHandshake other(key, Bytes{1}, Secret::random());
  (void)other.write_first({});
  EXPECT_NE(other.proof(text("seven")), ends.responder.proof(text("seven")));
}

}  // namespace
}  // namespace cairn::proto
