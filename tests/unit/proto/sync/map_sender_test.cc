#include "proto/sync/map_sender.h"

#include <gtest/gtest.h>

#include "proto/codec/patch.h"
#include "proto/sync/map_inbox.h"
#include "tests/support/sync_world.h"

namespace cairn::proto {
namespace {

using namespace testing;  // NOLINT: the test's own world

Tile some_tile(std::uint64_t seed, int cells) {
  std::mt19937_64 random(seed);
  Tile tile(1000);
  for (int i = 0; i < cells; ++i) {
    const auto at = static_cast<int>(random() % Tile::kCells);
    tile.set(at, {1000 + static_cast<int>(random() % 500),
                  static_cast<std::uint8_t>(1 + random() % 255)});
  }
  return tile;
}

MapOffer some_offer(std::uint64_t seed, std::uint32_t edition) {
  MapOffer offer;
  offer.edition = edition;
  for (int i = 0; i < 3; ++i) {
    const Tile tile = some_tile(seed + static_cast<std::uint64_t>(i), 700);
    offer.tiles.push_back({{0, i, -i}, PackedTile::pack(tile), 4});
  }
  for (std::uint32_t i = 1; i <= 80; ++i) {
    offer.moves.push_back({i, {static_cast<std::int32_t>(seed) + static_cast<std::int32_t>(i)}});
  }
  return offer;
}

void expect_same(const MapUpdate& update, const MapOffer& offer) {
  EXPECT_EQ(update.edition, offer.edition);
  EXPECT_EQ(update.moves, offer.moves);
  ASSERT_EQ(update.tiles.size(), offer.tiles.size());
  for (std::size_t i = 0; i < offer.tiles.size(); ++i) {
    EXPECT_EQ(update.tiles[i].key, offer.tiles[i].key);
    EXPECT_EQ(update.tiles[i].tile, offer.tiles[i].tile.unpack());
    EXPECT_EQ(update.tiles[i].holds_sequence, offer.tiles[i].holds_sequence);
  }
}

/// Frames of a sender until it waits, each acknowledged or not.
int send_all(MapSender& sender, MapInbox& inbox, std::vector<MapUpdate>& updates,
             std::uint32_t& number, bool arrives) {
  int frames = 0;
  while (sender.has_news()) {
    FrameWriter writer({Direction::down, 1, ++number});
    sender.fill(writer, number);
    const auto frame = decode_frame(std::move(writer).finish(), Direction::down);
    ++frames;
    if (!arrives) continue;
    for (const Record& record : frame->records) {
      if (const auto* patch = std::get_if<MapPatch>(&record)) {
        EXPECT_TRUE(inbox.on_patch(*patch));
      }
      if (const auto* move = std::get_if<SubmapMove>(&record)) inbox.on_move(*move);
      if (const auto* commit = std::get_if<MapCommit>(&record)) {
        if (auto update = inbox.on_commit(*commit)) updates.push_back(*std::move(update));
      }
    }
  }
  return frames;
}

TEST(MapSender, NothingIsUsedBeforeAllOfItHasBeenAcknowledged) {
  MapSender sender;
  MapInbox inbox;
  std::vector<MapUpdate> updates;
  std::uint32_t number = 0;
  const MapOffer offer = some_offer(7, 1);
  sender.offer(offer);
  const auto frames = static_cast<std::uint32_t>(send_all(sender, inbox, updates, number, true));
  EXPECT_TRUE(updates.empty());
  for (std::uint32_t i = 1; i < frames; ++i) sender.on_acked(i);
  EXPECT_FALSE(sender.has_news());
  sender.on_acked(frames);
  send_all(sender, inbox, updates, number, true);
  ASSERT_EQ(updates.size(), 1U);
  expect_same(updates[0], offer);
  EXPECT_FALSE(sender.idle());
  sender.on_acked(number);
  EXPECT_TRUE(sender.idle());
  EXPECT_EQ(sender.steps_done(), 1U);
}

TEST(MapSender, WhatWasLostIsSentAgain) {
  MapSender sender;
  MapInbox inbox;
  std::vector<MapUpdate> updates;
  std::uint32_t number = 0;
  const MapOffer offer = some_offer(3, 2);
  sender.offer(offer);
  send_all(sender, inbox, updates, number, false);
  for (std::uint32_t i = 1; i <= number; ++i) sender.on_lost(i);
  const std::uint32_t first = number + 1;
  send_all(sender, inbox, updates, number, true);
  for (std::uint32_t i = first; i <= number; ++i) sender.on_acked(i);
  send_all(sender, inbox, updates, number, true);
  ASSERT_EQ(updates.size(), 1U);
  expect_same(updates[0], offer);
}

TEST(MapSender, ATileThatHoldsNothingAnyMoreArrivesEmpty) {
  MapSender sender;
  MapInbox inbox;
  std::vector<MapUpdate> updates;
  std::uint32_t number = 0;
  sender.offer({{{{0, 5, 5}, PackedTile::pack(Tile(3000)), 0}}, {}, 0});
  send_all(sender, inbox, updates, number, true);
  sender.on_acked(number);
  send_all(sender, inbox, updates, number, true);
  ASSERT_EQ(updates.size(), 1U);
  ASSERT_EQ(updates[0].tiles.size(), 1U);
  EXPECT_EQ(updates[0].tiles[0].tile.known_count(), 0);
}

/// One cell of a tile, of step 1.
MapPatch patch_of_tile(const TileKey& tile) {
  BlockUpdate block{0, {EvidenceLayer::surface, tile, 0}, 0, 1, {}};
  block.delta.changed.set(0);
  block.delta.cells[0] = {100, 9};
  return {1, 0, write_patch({&block, 1}, {}, kExact, {}, kMaxPatchBytes).bytes};
}

TEST(MapInbox, APatchThatCannotBeReadChangesNothing) {
  MapInbox inbox;
  EXPECT_FALSE(inbox.on_patch({1, 0, {1, 2, 3, 4, 5, 6, 7, 8, 9}}));
  const auto step = inbox.on_commit({1, 0});
  ASSERT_TRUE(step);
  EXPECT_TRUE(step->tiles.empty());
}

TEST(MapInbox, ALateCopyOfAnOlderStepChangesNothing) {
  MapInbox inbox;
  const MapPatch old = patch_of_tile({0, 0, 0});
  EXPECT_TRUE(inbox.on_patch(old));
  ASSERT_TRUE(inbox.on_commit({1, 0}));
  EXPECT_TRUE(inbox.on_patch(old));
  inbox.on_move({1, 3, {1, 2, 3, 4}});
  EXPECT_FALSE(inbox.on_commit({1, 0}));
  const auto next = inbox.on_commit({2, 0});
  ASSERT_TRUE(next);
  EXPECT_TRUE(next->tiles.empty());
  EXPECT_TRUE(next->moves.empty());
}

TEST(MapInbox, WhatAServerSendsWithoutEverCommittingIsBounded) {
  MapInbox inbox;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_TRUE(inbox.on_patch(patch_of_tile({0, i, 0})));
    for (std::uint32_t k = 0; k < 10; ++k) {
      inbox.on_move({1, 1 + k + 10 * static_cast<std::uint32_t>(i), {}});
    }
  }
  const auto update = inbox.on_commit({1, 0});
  ASSERT_TRUE(update);
  EXPECT_EQ(update->tiles.size(), MapInbox::kMaxTiles);
  EXPECT_EQ(update->moves.size(), MapInbox::kMaxMoves);
}

TEST(MapDown, WhateverTheLinkDoesEachStepArrivesWholeAndInOrder) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SyncWorld world(seed, {.loss = 0.3,
                           .duplicate = 0.2,
                           .least_delay = milliseconds(20),
                           .most_delay = milliseconds(400)});
    ASSERT_TRUE(world.run_until(world.now + seconds(60), [&] { return world.robot.connected(); }));
    std::vector<MapUpdate> updates;
    std::vector<MapOffer> offers;
    for (std::uint32_t step = 1; step <= 3; ++step) {
      offers.push_back(some_offer(seed * 10 + step, step));
      world.server.link->map().offer(offers.back());
      ASSERT_TRUE(world.run_until(world.now + seconds(300),
                                  [&] { return world.server.link->map().idle(); }));
      for (MapUpdate& update : world.robot.take_map_updates()) updates.push_back(std::move(update));
    }
    ASSERT_EQ(updates.size(), offers.size());
    for (std::size_t i = 0; i < offers.size(); ++i) expect_same(updates[i], offers[i]);
    if (HasFailure()) break;
  }
}

}  // namespace
}  // namespace cairn::proto
