#include "proto/codec/range_coder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cairn::proto {
namespace {

struct Bit {
  bool is;
  std::uint32_t one;
};

/// Bits as likely as they are said to be.
std::vector<Bit> honest_bits(std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::uint32_t> probability(1, 65535);
  std::vector<Bit> bits;
  for (int i = 0; i < count; ++i) {
    const std::uint32_t one = probability(random);
    bits.push_back({random() % 65536 < one, one});
  }
  return bits;
}

std::vector<std::uint8_t> written(const std::vector<Bit>& bits) {
  std::vector<std::uint8_t> out;
  RangeEncoder encoder(out);
  for (const Bit& bit : bits) encoder.code(bit.is, bit.one);
  encoder.finish();
  return out;
}

void expect_read_back(const std::vector<Bit>& bits, const std::vector<std::uint8_t>& bytes,
                      std::uint64_t seed) {
  RangeDecoder decoder(bytes);
  for (const Bit& bit : bits) ASSERT_EQ(decoder.code(false, bit.one), bit.is) << "seed " << seed;
  EXPECT_TRUE(decoder.all_read()) << "seed " << seed;
  EXPECT_FALSE(decoder.overrun()) << "seed " << seed;
}

TEST(RangeCoder, WhatWasWrittenIsRead) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const auto bits = honest_bits(seed, static_cast<int>(seed * seed % 3000));
    expect_read_back(bits, written(bits), seed);
  }
}

TEST(RangeCoder, LikelyAndUnlikelyBitsComeBack) {
  for (const bool is : {false, true}) {
    for (const std::uint32_t one : {1U, 65535U}) {
      const std::vector<Bit> bits(500, Bit{is, one});
      expect_read_back(bits, written(bits), one);
    }
  }
}

TEST(RangeCoder, TakesHardlyMoreThanTheProbabilitiesSay) {
  const auto bits = honest_bits(5, 100'000);
  double information = 0.0;
  for (const Bit& bit : bits) {
    const double one = bit.one / 65536.0;
    information -= std::log2(bit.is ? one : 1.0 - one);
  }
  EXPECT_LT(static_cast<double>(written(bits).size()) * 8.0, information * 1.0005 + 16.0);
}

TEST(RangeCoder, CarriesRunThroughBytesOfOnes) {
  // The lower part of the range again and again, then the upper: the sum runs over.
  for (int lows = 0; lows < 200; ++lows) {
    std::vector<Bit> bits(static_cast<std::size_t>(lows), Bit{false, 1});
    bits.insert(bits.end(), 40, Bit{false, 65535});
    expect_read_back(bits, written(bits), static_cast<std::uint64_t>(lows));
  }
}

TEST(RangeCoder, BytesThatEndTooEarlyOrTooLateAreNoticed) {
  const auto bits = honest_bits(6, 4000);
  auto bytes = written(bits);
  bytes.insert(bytes.end(), 6, 1);
  RangeDecoder longer(bytes);
  for (const Bit& bit : bits) longer.code(false, bit.one);
  EXPECT_FALSE(longer.all_read());

  bytes.resize(bytes.size() - 12);
  RangeDecoder shorter(bytes);
  for (const Bit& bit : bits) shorter.code(false, bit.one);
  EXPECT_TRUE(shorter.overrun());
}

TEST(RangeCoder, TheBytesAreTheSameOnEveryMachine) {
  EXPECT_EQ(written({{true, 40000},
                     {false, 100},
                     {true, 65000},
                     {true, 32768},
                     {false, 32768},
                     {true, 7},
                     {false, 65535},
                     {true, 1}}),
            (std::vector<std::uint8_t>{0x26, 0xED, 0x2B, 0xF8, 0xF1}));
}

}  // namespace
}  // namespace cairn::proto
