#include "server/store/sqlite_store.h"

#include <gmock/gmock.h>

#include "tests/unit/server/store/store_fixture.h"

namespace cairn::server {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Some of everything.
Transaction sample_transaction() {
  Transaction all;
  SubmapRow merged = sample_submap(2);
  merged.state = SubmapState::merged;
  merged.blocks = 1;
  merged.final_versions = 8;
  merged.merge_order = 1;
  all.submaps = {sample_submap(1), merged};
  all.blocks = {sample_block(all.submaps[0].id, {EvidenceLayer::surface, {0, -5, 7}, 15}, 3),
                sample_block(all.submaps[0].id, {EvidenceLayer::seen_through, {-3, -5, 7}, 0}, 4),
                sample_block(merged.id, {EvidenceLayer::surface, {0, 0, 0}, 0}, 7)};
  all.tiles = {sample_tile({0, -33554432, 33554431}, 1), sample_tile({2, 0, 0}, 5)};
  all.loops = {sample_loop(1, 2)};
  all.tried = {{.a = sample_submap(1).id, .b = sample_submap(2).id, .tries = 2, .sigma_m = 0.5}};
  all.submaps[0].edition = 5;
  all.submaps[0].link = SubmapLink{{8000, -20, 3, 150}, 40, 11, 65};
  all.notes = {{"next_command", "12"}, {"empty", ""}};
  return all;
}

void expect_all(Store& store, const Transaction& expected) {
  const auto submaps = store.submaps();
  ASSERT_TRUE(submaps) << submaps.error().message;
  ASSERT_EQ(submaps->size(), 2U);
  EXPECT_TRUE(same((*submaps)[0], expected.submaps[0]));
  EXPECT_TRUE(same((*submaps)[1], expected.submaps[1]));
  const auto blocks = store.blocks_of(expected.submaps[0].id);
  ASSERT_TRUE(blocks) << blocks.error().message;
  ASSERT_EQ(blocks->size(), 2U);
  for (const BlockRow& wanted : {expected.blocks[0], expected.blocks[1]}) {
    EXPECT_TRUE(std::ranges::any_of(*blocks, [&](const auto& row) { return same(row, wanted); }));
  }
  const auto tiles = store.tiles();
  ASSERT_TRUE(tiles) << tiles.error().message;
  ASSERT_EQ(tiles->size(), 2U);
  for (const TileRow& wanted : expected.tiles) {
    EXPECT_TRUE(std::ranges::any_of(*tiles, [&](const auto& row) { return same(row, wanted); }));
  }
  const auto loops = store.loops();
  ASSERT_TRUE(loops) << loops.error().message;
  ASSERT_EQ(loops->size(), 1U);
  EXPECT_TRUE(same(loops->front(), expected.loops.front()));
  const auto tried = store.tried();
  ASSERT_TRUE(tried) << tried.error().message;
  ASSERT_EQ(tried->size(), 1U);
  EXPECT_EQ(tried->front().tries, 2U);
  EXPECT_EQ(tried->front().sigma_m, 0.5);
  const auto notes = store.notes();
  ASSERT_TRUE(notes) << notes.error().message;
  EXPECT_EQ(*notes, expected.notes);
}

class SqliteStoreTest : public StoreTest {};

TEST_F(SqliteStoreTest, GivesBackWhatWasCommitted) {
  const auto store = found();
  commit(*store, sample_transaction());
  expect_all(*store, sample_transaction());
}

TEST_F(SqliteStoreTest, ATileThatWasErasedIsGone) {
  const auto store = found();
  commit(*store, sample_transaction());
  commit(*store,
         {.submaps = {}, .blocks = {}, .tiles = {}, .erased_tiles = {{2, 0, 0}}, .notes = {}});
  const auto tiles = store->tiles();
  ASSERT_TRUE(tiles);
  ASSERT_EQ(tiles->size(), 1U);
  EXPECT_EQ(tiles->front().key, sample_transaction().tiles.front().key);
}

TEST_F(SqliteStoreTest, GivesBackWhatWasCommittedAfterReopening) {
  commit(*found(), sample_transaction());
  const auto store = reopen();
  expect_all(*store, sample_transaction());
  EXPECT_EQ(store->site().name, "quarry");
  EXPECT_EQ(store->site().epoch, sample_site().epoch);
  EXPECT_EQ(store->site().cell_size_mm, 125);
  EXPECT_EQ(store->site().founded_unix_s, 17);
}

TEST_F(SqliteStoreTest, ReplacesRowsOfTheSameKeyAndKeepsTheBlocksOfAReplacedSubmap) {
  const auto store = found();
  const Transaction first = sample_transaction();
  commit(*store, first);
  SubmapRow head = first.submaps[0];
  head.head_version = 9;
  const BlockRow block = sample_block(head.id, first.blocks[0].key, 99);
  const TileRow tile = sample_tile(first.tiles[0].key, 77);
  commit(
      *store,
      {.submaps = {head}, .blocks = {block}, .tiles = {tile}, .notes = {{"next_command", "13"}}});
  Transaction expected = first;
  expected.submaps[0] = head;
  expected.blocks[0] = block;
  expected.tiles[0] = tile;
  expected.notes["next_command"] = "13";
  expect_all(*store, expected);
}

TEST_F(SqliteStoreTest, FindsNothingToSayAboutASoundSite) {
  const auto store = found();
  commit(*store, sample_transaction());
  const auto report = store->verify();
  ASSERT_TRUE(report);
  EXPECT_THAT(report->faults, IsEmpty());
  EXPECT_EQ(report->submaps, 2U);
  EXPECT_EQ(report->blocks, 3U);
  EXPECT_EQ(report->tiles, 2U);
}

TEST_F(SqliteStoreTest, HasNoBlocksForASubmapItDoesNotKnow) {
  const auto blocks = found()->blocks_of({1, 1});
  ASSERT_TRUE(blocks);
  EXPECT_THAT(*blocks, IsEmpty());
}

TEST_F(SqliteStoreTest, WritesNothingForAnEmptyTransaction) {
  const auto store = found();
  const auto log = file_.string() + "-wal";
  const std::string before = content_of(log);
  commit(*store, {});
  EXPECT_EQ(content_of(log), before);
}

TEST_F(SqliteStoreTest, KeepsNothingOfATransactionWithOneBadRow) {
  const auto store = found();
  Transaction bad{.submaps = {sample_submap(1)},
                  .blocks = {sample_block({7, 7}, {}, 1)},
                  .tiles = {sample_tile({}, 1)},
                  .notes = {{"note", "value"}}};
  const Status refused = store->commit(bad);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
  EXPECT_THAT(refused.error().message, HasSubstr("submap 0000000000000007/7"));
  EXPECT_THAT(*store->submaps(), IsEmpty());
  EXPECT_THAT(*store->tiles(), IsEmpty());
  EXPECT_THAT(*store->notes(), IsEmpty());
  bad.blocks.clear();
  commit(*store, bad);
  EXPECT_EQ(store->submaps()->size(), 1U);
}

TEST_F(SqliteStoreTest, RefusesNotesBeyondTheirBounds) {
  const auto store = found();
  EXPECT_FALSE(store->commit({.submaps = {}, .blocks = {}, .tiles = {}, .notes = {{"", "x"}}}));
  EXPECT_FALSE(store->commit(
      {.submaps = {}, .blocks = {}, .tiles = {}, .notes = {{"x", std::string(65537, 'x')}}}));
  EXPECT_TRUE(store->commit(
      {.submaps = {}, .blocks = {}, .tiles = {}, .notes = {{"x", std::string(65536, 'x')}}}));
}

}  // namespace
}  // namespace cairn::server
