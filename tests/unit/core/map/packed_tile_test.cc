#include "core/map/packed_tile.h"

#include <gtest/gtest.h>

#include <random>

namespace cairn {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const PackedTile& packed) { return {packed.bytes().begin(), packed.bytes().end()}; }

/// Two cells: (0, 0) at -1 mm from the datum and (9, 10) at +258 mm.
Tile two_cells() {
  Tile tile(-3000);
  tile.set(Tile::index(0, 0), {-3001, 7});
  tile.set(Tile::index(9, 10), {-2742, 250});
  return tile;
}

const Bytes kTwoCells = {
    1,                                               // version
    0x48, 0xF4, 0xFF, 0xFF,                          // datum -3000
    0x01, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,  // blocks 0 and 9
    0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,  // its cell (0, 0)
    0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00,  // its cell (1, 2)
    0xFF, 0xFF, 0x02, 0x01,                          // heights -1 and 258
    7,    250,                                       // probabilities
};

Tile random_tile(std::mt19937& random, int one_in) {
  Tile tile(static_cast<std::int32_t>(random() % 20'000) - 10'000);
  for (int i = 0; i < Tile::kCells; ++i) {
    if (random() % static_cast<unsigned>(one_in) != 0) continue;
    const int offset = static_cast<int>(random() % 65'535) - Tile::kHeightLimitMm;
    tile.set(i, {tile.datum_mm() + offset, static_cast<std::uint8_t>(1 + random() % 255)});
  }
  return tile;
}

ErrorCode code_of(const Bytes& bytes) {
  const auto packed = PackedTile::from_bytes(bytes);
  EXPECT_FALSE(packed);
  return packed ? ErrorCode::io : packed.error().code;
}

TEST(PackedTile, HasTheBytesOfTheFormat) {
  EXPECT_EQ(bytes_of(PackedTile::pack(two_cells())), kTwoCells);
}

TEST(PackedTile, ReadsTheBytesOfTheFormat) {
  const auto packed = PackedTile::from_bytes(kTwoCells);
  ASSERT_TRUE(packed);
  EXPECT_EQ(packed->known_count(), 2);
  EXPECT_EQ(packed->unpack(), two_cells());
}

TEST(PackedTile, GivesBackEveryTile) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const Tile tile = random_tile(random, 1 + static_cast<int>(seed % 6) * 40);
    const PackedTile packed = PackedTile::pack(tile);
    EXPECT_EQ(packed.unpack(), tile);
    EXPECT_EQ(packed.known_count(), tile.known_count());
    const auto again = PackedTile::from_bytes(packed.bytes());
    ASSERT_TRUE(again);
    EXPECT_EQ(*again, packed);
  }
}

TEST(PackedTile, TakesItsWorstRoomWhenFullAndThirteenBytesWhenEmpty) {
  std::mt19937 random(1);
  EXPECT_EQ(PackedTile::pack(random_tile(random, 1)).bytes().size(), PackedTile::kMaxBytes);
  EXPECT_EQ(PackedTile::pack(Tile(0)).bytes().size(), 13U);
  EXPECT_TRUE(PackedTile::from_bytes(PackedTile::pack(Tile(0)).bytes()));
}

TEST(PackedTile, RefusesEveryTruncationAndBytesLeftOver) {
  for (std::size_t size = 0; size < kTwoCells.size(); ++size) {
    const Bytes cut(kTwoCells.begin(), kTwoCells.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(code_of(cut), ErrorCode::corrupt) << size << " bytes";
  }
  Bytes longer = kTwoCells;
  longer.push_back(1);
  EXPECT_EQ(code_of(longer), ErrorCode::corrupt);
}

TEST(PackedTile, RefusesWhatPackNeverWrites) {
  const auto with = [](std::size_t at, std::uint8_t value) {
    Bytes bytes = kTwoCells;
    bytes[at] = value;
    return bytes;
  };
  EXPECT_EQ(code_of(with(0, 2)), ErrorCode::unsupported_version);
  EXPECT_EQ(code_of(with(33, 0)), ErrorCode::corrupt) << "probability 0";
  EXPECT_EQ(code_of(with(13, 0)), ErrorCode::corrupt) << "an empty mask";
  EXPECT_EQ(code_of(with(6, 3)), ErrorCode::corrupt) << "one block more than masks";
  Bytes lowest = with(29, 0x00);
  lowest[30] = 0x80;
  EXPECT_EQ(code_of(lowest), ErrorCode::corrupt) << "an offset of -32768";
}

TEST(PackedTile, RefusesHeightsBeyondThirtyTwoBits) {
  Bytes bytes = kTwoCells;
  bytes[1] = 0xFF, bytes[2] = 0xFF, bytes[3] = 0xFF, bytes[4] = 0x7F;
  EXPECT_EQ(code_of(bytes), ErrorCode::corrupt);
}

TEST(PackedTile, SurvivesRandomBytes) {
  std::mt19937 random(7);
  for (int round = 0; round < 20'000; ++round) {
    Bytes bytes = kTwoCells;
    for (unsigned flips = 1 + random() % 4; flips > 0; --flips) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    const auto packed = PackedTile::from_bytes(bytes);
    if (!packed) continue;
    EXPECT_EQ(bytes_of(PackedTile::pack(packed->unpack())), bytes);
  }
}

}  // namespace
}  // namespace cairn
