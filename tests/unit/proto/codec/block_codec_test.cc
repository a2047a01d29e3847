#include "proto/codec/block_codec.h"

#include <gtest/gtest.h>

#include "proto/codec/frame.h"
#include "tests/support/random_records.h"
#include "tests/support/sample_records.h"

namespace cairn::proto {
namespace {

/// Every cell changed and known, heights jumping from one end of what fits to the other.
BlockUpdate worst_block() {
  BlockUpdate update{1, {}, 0, 1, {}};
  update.delta.datum_mm = -kMaxCoordinateMm;
  update.delta.changed.set();
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    const int side = i % 2 == 0 ? 1 : -1;
    update.delta.cells[i] = {update.delta.datum_mm + side * Tile::kHeightLimitMm, 255};
  }
  return update;
}

bool refused(const std::vector<std::uint8_t>& payload) {
  BlockDelta delta;
  ByteReader reader(payload);
  read_block(reader, delta);
  return reader.failed();
}

std::vector<std::uint8_t> payload_of(const BlockDelta& delta) {
  std::vector<std::uint8_t> out;
  ByteWriter writer(out);
  write_block(writer, delta);
  return out;
}

TEST(BlockCodec, TheWorstBlockFitsIntoOneFrameWithAnAckAndItsHead) {
  FrameWriter frame({Direction::up, 1, 1});
  EXPECT_TRUE(frame.add(Ack{}));
  EXPECT_TRUE(frame.add(SubmapHead{1, 1, {}, false, 0, 0}));
  EXPECT_TRUE(frame.add(worst_block()));
  EXPECT_LE(frame.size_bytes(), kMaxFrameBytes);
  EXPECT_TRUE(decode_frame(std::move(frame).finish(), Direction::up));
}

TEST(BlockCodec, NoPayloadIsLongerThanItsBound) {
  EXPECT_LE(payload_of(worst_block().delta).size(), kMaxBlockPayloadBytes);
  testing::RandomRecords random(11);
  for (int i = 0; i < 500; ++i) {
    ASSERT_LE(payload_of(random.block().delta).size(), kMaxBlockPayloadBytes);
  }
}

TEST(BlockCodec, AFewSmoothCellsAreThreeBytesEach) {
  BlockDelta delta;
  for (std::size_t i = 40; i < 50; ++i) {
    delta.changed.set(i);
    delta.cells[i] = {static_cast<int>(i), 200};
  }
  EXPECT_EQ(payload_of(delta).size(), 1U + 10U * 3U);
}

TEST(BlockCodec, RandomBlocksComeBack) {
  testing::RandomRecords random(12);
  for (int i = 0; i < 2000; ++i) {
    const BlockDelta sent = random.block().delta;
    const auto bytes = payload_of(sent);
    BlockDelta got{.datum_mm = sent.datum_mm, .changed = {}, .cells = {}};
    ByteReader reader(bytes);
    read_block(reader, got);
    ASSERT_FALSE(reader.failed()) << "block " << i;
    ASSERT_EQ(reader.left(), 0U) << "block " << i;
    ASSERT_TRUE(testing::same_delta(sent, got)) << "block " << i;
  }
}

TEST(BlockCodec, ListedCellsMustAscend) {
  EXPECT_FALSE(refused({2, 4, 5, 0, 0}));
  EXPECT_TRUE(refused({2, 5, 4, 0, 0}));
  EXPECT_TRUE(refused({2, 5, 5, 0, 0}));
}

TEST(BlockCodec, AMaskIsOnlyForManyCells) {
  std::vector<std::uint8_t> mask_of_eight(1 + 32 + 8, 0);
  mask_of_eight[1] = 0xFF;
  EXPECT_TRUE(refused(mask_of_eight));
  std::vector<std::uint8_t> mask_of_32(1 + 32 + 32, 0);
  std::fill_n(mask_of_32.begin() + 1, 4, std::uint8_t{0xFF});
  EXPECT_FALSE(refused(mask_of_32));
}

TEST(BlockCodec, AListIsOnlyForFewCells) {
  std::vector<std::uint8_t> list_of_32(1 + 32 + 32, 0);
  list_of_32[0] = 32;
  for (std::uint8_t i = 0; i < 32; ++i) list_of_32[1U + i] = i;
  EXPECT_TRUE(refused(list_of_32));
}

TEST(BlockCodec, HeightsThatDoNotFitTheDatumAreRefused) {
  EXPECT_FALSE(refused({1, 0, 9, 0xFE, 0xFF, 0x03}));  // +32767
  EXPECT_TRUE(refused({1, 0, 9, 0x80, 0x80, 0x04}));   // +32768
  EXPECT_TRUE(refused({1, 0, 9, 0xFF, 0xFF, 0x03}));   // -32768
}

TEST(BlockCodec, ACutPayloadIsRefused) {
  const auto bytes = payload_of(testing::sample_block().delta);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_TRUE(refused({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)}));
  }
}

}  // namespace
}  // namespace cairn::proto
