#include "server/store/row_codec.h"

#include <gmock/gmock.h>

#include <limits>

#include "tests/unit/server/store/store_fixture.h"

namespace cairn::server {
namespace {

using testing::ElementsAre;

TEST(TileKeyOnDisk, ComesBackAtEveryCornerOfWhatItHolds) {
  for (const int level : {-128, -1, 0, 1, 127}) {
    for (const std::int32_t c : {-(1 << 27), -(1 << 25), -1, 0, 1, (1 << 25) - 1, (1 << 27) - 1}) {
      const TileKey key{static_cast<std::int8_t>(level), c, -1 - c};
      ASSERT_TRUE(storable(key));
      EXPECT_EQ(unpack_tile(pack(key)), key) << level << ' ' << c;
    }
  }
  EXPECT_FALSE(storable({0, 1 << 27, 0}));
  EXPECT_FALSE(storable({0, 0, std::numeric_limits<std::int32_t>::min()}));
}

TEST(BlockKeyOnDisk, RefusesAPartThatDoesNotExist) {
  EXPECT_TRUE(unpack_block(0, 31));
  EXPECT_FALSE(unpack_block(0, 32));
  EXPECT_FALSE(unpack_block(0, -1));
}

// The example of FORMAT.md.
TEST(BlockOnDisk, HasTheBytesOfTheFormat) {
  const SubmapId id{0x0102030405060708, 9};
  BlockRow row{
      .id = id, .key = {EvidenceLayer::seen_through, {0, 1, -1}, 5}, .version = 2, .state = {}};
  row.state.datum_mm = 1000;
  row.state.changed.set(0).set(9);
  row.state.cells[0] = {990, 200};
  row.state.cells[9] = {1300, 1};
  const auto body = encode(row);
  ASSERT_TRUE(body);
  Bytes expected{2, 0, 0, 0, 0xE8, 3, 0, 0, 1, 2};
  expected.resize(8 + 32);
  expected.insert(expected.end(), {200, 0xF6, 0xFF, 1, 0x2C, 1});
  EXPECT_EQ(*body, expected);
  EXPECT_EQ(pack(row.key.tile), 0x1FFFFFFF);
  EXPECT_EQ(pack_part(row.key), 21);
  EXPECT_THAT(key_of(id, row.key), ElementsAre('B', 8, 7, 6, 5, 4, 3, 2, 1, 9, 0, 0, 0, 0xFF, 0xFF,
                                               0xFF, 0x1F, 0, 0, 0, 0, 21));
  EXPECT_EQ(row_crc(key_of(id, row.key), *body), 0xDD658E9FU);
}

TEST(BlockOnDisk, LeavesOutCellsThatAreUnknown) {
  BlockRow row{.id = {}, .key = {}, .version = 1, .state = {}};
  row.state.changed.set(7);
  const auto body = encode(row);
  ASSERT_TRUE(body);
  const auto back = decode_block({}, {}, *body);
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->state.changed.none());
}

TEST(BlockOnDisk, IsRefusedWhenAHeightDoesNotFit) {
  BlockRow row{.id = {}, .key = {}, .version = 1, .state = {}};
  row.state.changed.set(7);
  row.state.cells[7] = {32768, 1};
  EXPECT_FALSE(encode(row));
  row.state.cells[7] = {-32767, 1};
  EXPECT_TRUE(encode(row));
}

TEST(BlockOnDisk, IsRefusedWhenBytesAreMissingOrLeftOver) {
  const auto body = encode(sample_block({}, {}, 1));
  ASSERT_TRUE(body);
  for (std::size_t size = 0; size < body->size(); ++size) {
    EXPECT_FALSE(decode_block({}, {}, ByteSpan(*body).first(size))) << size;
  }
  Bytes longer = *body;
  longer.push_back(0);
  EXPECT_FALSE(decode_block({}, {}, longer));
}

TEST(SubmapOnDisk, IsRefusedWhenBytesAreMissingOrLeftOverOrOutOfBounds) {
  auto body = encode(sample_submap(1));
  ASSERT_TRUE(body);
  for (std::size_t size = 0; size < body->size(); ++size) {
    EXPECT_FALSE(decode_submap({}, ByteSpan(*body).first(size))) << size;
  }
  Bytes with_state_3 = *body;
  with_state_3[1 + 7 + 4 + 16] = 3;
  EXPECT_FALSE(decode_submap({}, with_state_3));
  body->push_back(0);
  EXPECT_FALSE(decode_submap({}, *body));
  SubmapRow nameless = sample_submap(1);
  nameless.robot = "";
  EXPECT_FALSE(encode(nameless));
}

}  // namespace
}  // namespace cairn::server
