#include "proto/codec/bytes.h"

#include <gtest/gtest.h>

#include <limits>

namespace cairn::proto {
namespace {

std::vector<std::uint8_t> varint(std::int32_t value) {
  std::vector<std::uint8_t> out;
  ByteWriter(out).put_varint(value);
  return out;
}

TEST(Bytes, NumbersAreLittleEndian) {
  std::vector<std::uint8_t> out;
  ByteWriter writer(out);
  writer.put(std::uint32_t{0x01020304});
  writer.put(std::int16_t{-2});
  EXPECT_EQ(out, (std::vector<std::uint8_t>{4, 3, 2, 1, 0xFE, 0xFF}));
}

TEST(Bytes, WhatWasWrittenIsRead) {
  std::vector<std::uint8_t> out;
  ByteWriter writer(out);
  writer.put(std::uint64_t{0xFFEEDDCCBBAA9988});
  writer.put(std::int8_t{-128});
  writer.put(std::int32_t{-1});
  ByteReader reader(out);
  EXPECT_EQ(reader.get<std::uint64_t>(), 0xFFEEDDCCBBAA9988);
  EXPECT_EQ(reader.get<std::int8_t>(), -128);
  EXPECT_EQ(reader.get<std::int32_t>(), -1);
  EXPECT_FALSE(reader.failed());
}

TEST(Bytes, ReadingPastTheEndFailsAndGivesZeros) {
  const std::vector<std::uint8_t> three = {1, 2, 3};
  ByteReader reader(three);
  EXPECT_EQ(reader.get<std::uint32_t>(), 0U);
  EXPECT_TRUE(reader.failed());
  EXPECT_EQ(reader.get<std::uint8_t>(), 0U);
}

TEST(Bytes, SmallDifferencesTakeOneByteAndHeightDifferencesAtMostThree) {
  EXPECT_EQ(varint(0).size(), 1U);
  EXPECT_EQ(varint(-64).size(), 1U);
  EXPECT_EQ(varint(63).size(), 1U);
  EXPECT_EQ(varint(64).size(), 2U);
  EXPECT_EQ(varint(2 * 32767).size(), 3U);
  EXPECT_EQ(varint(-2 * 32767).size(), 3U);
}

TEST(Bytes, EveryVarintIsReadBack) {
  for (const std::int32_t value :
       {0, 1, -1, 127, -128, 65'534, -65'534, std::numeric_limits<std::int32_t>::max(),
        std::numeric_limits<std::int32_t>::min()}) {
    const auto bytes = varint(value);
    ByteReader reader(bytes);
    EXPECT_EQ(reader.get_varint(), value);
    EXPECT_FALSE(reader.failed());
    EXPECT_EQ(reader.left(), 0U);
  }
}

TEST(Bytes, VarintsThatAreTooLongTooBigOrCutAreRefused) {
  const std::vector<std::vector<std::uint8_t>> bad = {
      {0x80, 0x00},                          // Longer than needed.
      {0xFF, 0xFF, 0xFF, 0xFF, 0x1F},        // 33 bits.
      {0xFF, 0xFF, 0xFF, 0xFF, 0x8F, 0x01},  // Six bytes.
      {0x80},                                // Cut.
  };
  for (const auto& bytes : bad) {
    ByteReader reader(bytes);
    EXPECT_EQ(reader.get_varint(), 0);
    EXPECT_TRUE(reader.failed());
  }
}

}  // namespace
}  // namespace cairn::proto
