#include "server/world/audit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/server/world/world_fixture.h"

namespace cairn::server {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// A store with two merged submaps and an open one, closed by its world.
class AuditTest : public WorldTest {
 protected:
  AuditTest() {
    Surveyor robot;
    robot.survey({0, 0}, 0);
    robot.survey({20, 20}, 30, {.x_mm = 8000});
    robot.begin();
    robot.see({0, 0}, 4, {500, 200});
    deliver(robot);
    world.reset();
  }
  [[nodiscard]] Audit audited() const {
    const auto store = reopen();
    auto report = audit(*store, SensorModel{});
    EXPECT_TRUE(report) << report.error().message;
    return std::move(report).value();
  }
  [[nodiscard]] std::vector<SubmapRow> rows() const {
    const auto store = reopen();
    return store->submaps().value();
  }
  void write(const Transaction& transaction) const {
    const auto store = reopen();
    commit(*store, transaction);
  }
};

TEST_F(AuditTest, FindsASoundStoreSound) {
  const Audit audit = audited();
  EXPECT_TRUE(audit.sound());
  EXPECT_EQ(audit.merged_submaps, 2U);
  EXPECT_EQ(audit.compared_tiles, 2U);
}

TEST_F(AuditTest, FindsANewStoreSound) {
  file_ = folder_ / "new.cairn";
  { const auto store = found(); }
  EXPECT_TRUE(audited().sound());
}

TEST_F(AuditTest, FindsATileThatIsNotTheFoldOfItsEvidence) {
  TileRow row = reopen()->tiles().value().front();
  Tile tile = row.tile.unpack();
  tile.set(0, {tile.datum_mm() + 1, 201});
  row.tile = PackedTile::pack(tile);
  write({.submaps = {}, .blocks = {}, .tiles = {row}, .notes = {}});
  EXPECT_THAT(audited().faults, Contains(HasSubstr("differs from the fold")));
}

TEST_F(AuditTest, FindsATileWithoutEvidence) {
  TileRow row = reopen()->tiles().value().front();
  row.key = {0, 77, -8};
  write({.submaps = {}, .blocks = {}, .tiles = {row}, .notes = {}});
  EXPECT_THAT(audited().faults,
              Contains(HasSubstr("(level 0, 77, -8) is stored, but no evidence")));
}

TEST_F(AuditTest, FindsATileThatIsMissing) {
  tamper(file_, "DELETE FROM tile WHERE key = (SELECT min(key) FROM tile)");
  const Audit audit = audited();
  EXPECT_THAT(audit.faults, Contains(HasSubstr("is missing, though evidence touches it")));
}

TEST_F(AuditTest, FindsAMissingBlockOfAMergedSubmap) {
  tamper(file_,
         "DELETE FROM block WHERE (submap, tile, part) = "
         "(SELECT submap, tile, part FROM block ORDER BY submap LIMIT 1)");
  EXPECT_FALSE(audited().sound());
}

TEST_F(AuditTest, FindsABlockThatWasChangedWithItsChecksumMadeRight) {
  const auto store = reopen();
  BlockRow row = store->blocks_of({1, 1}).value().front();
  for (Cell& cell : row.state.cells) cell.height_mm += 7;
  commit(*store, {.submaps = {}, .blocks = {row}, .tiles = {}, .notes = {}});
  const auto report = audit(*store, SensorModel{});
  ASSERT_TRUE(report);
  EXPECT_THAT(report->faults, Contains(HasSubstr("differs from the fold")));
}

TEST_F(AuditTest, FindsAMergeOrderThatIsThereTwice) {
  std::vector<SubmapRow> merged = rows();
  std::erase_if(merged, [](const SubmapRow& row) { return row.merge_order == 0; });
  ASSERT_EQ(merged.size(), 2U);
  for (SubmapRow& row : merged) row.merge_order = 1;
  write({.submaps = merged, .blocks = {}, .tiles = {}, .notes = {}});
  EXPECT_THAT(audited().faults, Contains(HasSubstr("has merge order 1 where 2 was expected")));
}

TEST_F(AuditTest, FindsAGapInTheMergeOrder) {
  std::vector<SubmapRow> merged = rows();
  std::erase_if(merged, [](const SubmapRow& row) { return row.merge_order != 2; });
  merged.front().merge_order = 3;
  write({.submaps = merged, .blocks = {}, .tiles = {}, .notes = {}});
  EXPECT_THAT(audited().faults, Contains(HasSubstr("has merge order 3 where 2 was expected")));
}

TEST_F(AuditTest, FindsASubmapThatWasForgottenAfterItsMerge) {
  std::vector<SubmapRow> merged = rows();
  std::erase_if(merged, [](const SubmapRow& row) { return row.merge_order != 2; });
  merged.front().merge_order = 0;
  merged.front().state = SubmapState::closed;
  write({.submaps = merged, .blocks = {}, .tiles = {}, .notes = {}});
  EXPECT_FALSE(audited().sound());
}

TEST_F(AuditTest, ReportsABitThatFlippedAndFoldsNothing) {
  tamper(file_,
         "UPDATE tile SET body = zeroblob(length(body)) WHERE key = (SELECT min(key) FROM "
         "tile)");
  const Audit audit = audited();
  EXPECT_FALSE(audit.store.faults.empty());
  EXPECT_EQ(audit.merged_submaps, 0U);
}

TEST_F(AuditTest, KeepsTheWorldFromOpeningOnARowItCannotTrust) {
  tamper(file_,
         "UPDATE tile SET body = zeroblob(length(body)) WHERE key = (SELECT min(key) FROM "
         "tile)");
  const auto opened = World::open(reopen(), SensorModel{});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::corrupt);
}

}  // namespace
}  // namespace cairn::server
