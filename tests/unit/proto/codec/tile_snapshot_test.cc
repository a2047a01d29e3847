#include "proto/codec/tile_snapshot.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <random>

namespace cairn::proto {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Cells (0, 0), (1, 0), (0, 1), (1, 1) and (9, 10) of a tile at -3000 mm.
Tile five_cells() {
  Tile tile(-3000);
  tile.set(Tile::index(0, 0), {-3001, 7});
  tile.set(Tile::index(1, 0), {-2991, 8});
  tile.set(Tile::index(0, 1), {-2981, 9});
  tile.set(Tile::index(1, 1), {-2999, 10});
  tile.set(Tile::index(9, 10), {-2742, 250});
  return tile;
}

const Bytes kFiveCellsInPlanes = {
    0x48, 0xF4, 0xFF, 0xFF,                          // datum -3000
    0x01, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,  // blocks 0 and 9
    0x03, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,  // its cells (0, 0), (1, 0), (0, 1), (1, 1)
    0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00,  // its cell (1, 2)
    0x01, 0x14, 0x28, 0x23, 0x02,                    // misses -1, 10, 20, 1 - 19, 258 - 1,
    0x00, 0x00, 0x00, 0x00, 0x02,                    // zig-zagged: low and high bytes
    7,    8,    9,    10,   250,                     // probabilities
};

Bytes snapshot_of(const Bytes& planes) {
  Bytes bytes(1 + ZSTD_compressBound(planes.size()));
  bytes[0] = 2;
  bytes.resize(1 + ZSTD_compress(&bytes[1], bytes.size() - 1, planes.data(), planes.size(), 1));
  return bytes;
}

ErrorCode code_of(const Bytes& bytes) {
  const auto tile = read_tile_snapshot(bytes);
  EXPECT_FALSE(tile);
  return tile ? ErrorCode::io : tile.error().code;
}

TEST(TileSnapshot, HasTheBytesOfTheFormat) {
  const Bytes bytes = write_tile_snapshot(PackedTile::pack(five_cells()));
  ASSERT_GT(bytes.size(), 1U);
  EXPECT_EQ(bytes[0], 2);
  Bytes planes(1000);
  planes.resize(ZSTD_decompress(planes.data(), planes.size(), &bytes[1], bytes.size() - 1));
  EXPECT_EQ(planes, kFiveCellsInPlanes);
}

TEST(TileSnapshot, ReadsTheBytesOfTheFormat) {
  const auto tile = read_tile_snapshot(snapshot_of(kFiveCellsInPlanes));
  ASSERT_TRUE(tile) << tile.error().message;
  EXPECT_EQ(*tile, PackedTile::pack(five_cells()));
}

TEST(TileSnapshot, GivesBackEveryTileToTheBit) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    Tile tile(static_cast<std::int32_t>(random() % 20'000) - 10'000);
    const unsigned one_in = 1 + seed % 6 * 40;
    for (int i = 0; i < Tile::kCells; ++i) {
      if (random() % one_in != 0) continue;
      const int offset = static_cast<int>(random() % 65'535) - Tile::kHeightLimitMm;
      tile.set(i, {tile.datum_mm() + offset, static_cast<std::uint8_t>(1 + random() % 255)});
    }
    const PackedTile packed = PackedTile::pack(tile);
    const Bytes bytes = write_tile_snapshot(packed);
    EXPECT_LE(bytes.size(), kMaxTileSnapshotBytes);
    const auto read = read_tile_snapshot(bytes);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, packed);
  }
}

TEST(TileSnapshot, RefusesWhatIsCutOrLongerOrOfAnotherVersion) {
  EXPECT_EQ(code_of({}), ErrorCode::corrupt);
  EXPECT_EQ(code_of({1, 0, 0}), ErrorCode::unsupported_version);
  const Bytes whole = write_tile_snapshot(PackedTile::pack(five_cells()));
  for (std::size_t size = 1; size < whole.size(); ++size) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(code_of(cut), ErrorCode::corrupt) << size << " bytes";
  }
  for (std::size_t size = 0; size < kFiveCellsInPlanes.size(); ++size) {
    Bytes cut = kFiveCellsInPlanes;
    cut.resize(size);
    EXPECT_EQ(code_of(snapshot_of(cut)), ErrorCode::corrupt) << size << " bytes of planes";
  }
  Bytes longer = kFiveCellsInPlanes;
  longer.push_back(1);
  EXPECT_EQ(code_of(snapshot_of(longer)), ErrorCode::corrupt);
}

TEST(TileSnapshot, RefusesMoreThanATileHoweverSmallItIsCompressed) {
  EXPECT_EQ(code_of(snapshot_of(Bytes(std::size_t{100} << 20U, 0))), ErrorCode::corrupt);
}

TEST(TileSnapshot, RefusesAHeightThatNoTileHolds) {
  Bytes planes = kFiveCellsInPlanes;
  planes[28] = 0xFF, planes[33] = 0xFF;  // -32768 from the datum.
  EXPECT_EQ(code_of(snapshot_of(planes)), ErrorCode::corrupt);
}

TEST(TileSnapshot, SurvivesRandomBytes) {
  std::mt19937 random(7);
  const Bytes whole = write_tile_snapshot(PackedTile::pack(five_cells()));
  for (int round = 0; round < 20'000; ++round) {
    Bytes planes = kFiveCellsInPlanes;
    Bytes bytes = whole;
    for (unsigned flips = 1 + random() % 4; flips > 0; --flips) {
      planes[random() % planes.size()] = static_cast<std::uint8_t>(random());
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    (void)read_tile_snapshot(bytes);
    const auto read = read_tile_snapshot(snapshot_of(planes));
    if (!read) continue;
    const auto again = read_tile_snapshot(write_tile_snapshot(*read));
    ASSERT_TRUE(again);
    EXPECT_EQ(*again, *read);
  }
}

}  // namespace
}  // namespace cairn::proto
