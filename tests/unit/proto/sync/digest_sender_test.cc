#include "proto/sync/digest_sender.h"

#include <gtest/gtest.h>

namespace cairn::proto {
namespace {

TEST(TileDigest, IsNoneOfATileInWhichNothingIsKnown) {
  EXPECT_EQ(digest_of(PackedTile::pack(Tile(0))), 0U);
  EXPECT_EQ(digest_of(PackedTile::pack(Tile(5000))), 0U);
}

TEST(TileDigest, TellsTilesApartByASingleCellAndByTheDatum) {
  Tile tile(0);
  tile.set(7, {100, 200});
  Tile other = tile;
  other.set(7, {100, 201});
  Tile elsewhere(10);
  elsewhere.set(7, {100, 200});
  EXPECT_NE(digest_of(PackedTile::pack(tile)), digest_of(PackedTile::pack(other)));
  EXPECT_NE(digest_of(PackedTile::pack(tile)), digest_of(PackedTile::pack(elsewhere)));
}

TEST(TileDigest, NamesEveryTileByItsRegionAndPlace) {
  for (std::int32_t tx = -9; tx <= 9; ++tx) {
    for (std::int32_t ty = -9; ty <= 9; ++ty) {
      const TileKey key{-2, tx, ty};
      const Region region = region_of(key);
      const MapDigest digest{false, 0, region.level, region.rx, region.ry, {}};
      EXPECT_EQ(tile_of(digest, {place_of(key), 0}), key);
    }
  }
  EXPECT_EQ(region_of({0, -1, 4}), (Region{0, -1, 1}));
}

class DigestSenderTest : public ::testing::Test {
 protected:
  int fill(std::uint32_t number) {
    FrameWriter frame({Direction::up, 1, number});
    return sender.fill(frame, number);
  }
  DigestSender sender;
};

TEST_F(DigestSenderTest, SaysEachUntilItIsAcknowledged) {
  sender.tell({{false, 0, 0, 1, 1, {{0, 1}}}, {true, 0, 0, 1, 2, {}}});
  EXPECT_EQ(fill(1), 2);
  EXPECT_FALSE(sender.has_news());
  sender.on_lost(1);
  EXPECT_EQ(fill(2), 2);
  sender.on_acked(2);
  EXPECT_TRUE(sender.idle());
}

TEST_F(DigestSenderTest, ALateAcknowledgementCounts) {
  sender.tell({{}});
  EXPECT_EQ(fill(1), 1);
  sender.on_lost(1);
  sender.on_acked(1);
  EXPECT_TRUE(sender.idle());
}

TEST_F(DigestSenderTest, ANewSessionBeginsWithNothingToSay) {
  sender.tell({{}});
  sender.on_session();
  EXPECT_TRUE(sender.idle());
}

TEST_F(DigestSenderTest, TakesNoMoreThanItsBound) {
  sender.tell(std::vector<MapDigest>(DigestSender::kMaxWaiting + 9));
  int sent = 0;
  for (std::uint32_t number = 1; sender.has_news(); ++number) sent += fill(number);
  EXPECT_EQ(sent, static_cast<int>(DigestSender::kMaxWaiting));
}

}  // namespace
}  // namespace cairn::proto
