#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <iomanip>

#include "server/store/row_codec.h"
#include "tests/unit/server/store/store_fixture.h"

namespace cairn::server {
namespace {

using testing::HasSubstr;

class Opening : public StoreTest {
 protected:
  void write_file(std::string_view content) const {
    std::ofstream(file_, std::ios::binary) << content;
  }
  void expect_refused(ErrorCode code, const std::string& hint) const {
    const auto store = SqliteStore::open(file_);
    ASSERT_FALSE(store);
    EXPECT_EQ(store.error().code, code) << store.error().message;
    EXPECT_THAT(store.error().message, HasSubstr(hint));
  }
};

std::string hex_of(const Bytes& bytes) {
  std::ostringstream hex;
  for (const std::uint8_t byte : bytes) {
    hex << std::hex << std::setfill('0') << std::setw(2) << int{byte};
  }
  return hex.str();
}

/// Runs `task` in a process of its own; its result is the exit code.
int in_other_process(const std::function<int()>& task) {
  const pid_t child = fork();
  if (child == 0) _exit(task());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(Opening, IsRefusedWhileAnotherProcessHoldsTheSite) {
  int ready[2];
  int done[2];
  ASSERT_EQ(pipe(ready), 0);
  ASSERT_EQ(pipe(done), 0);
  char token = 0;
  const pid_t holder = fork();
  if (holder == 0) {
    close(done[1]);
    const auto store = SqliteStore::create(file_, sample_site());
    (void)!write(ready[1], &token, 1);
    (void)!read(done[0], &token, 1);  // Ends when the parent closes its end.
    _exit(store ? 0 : 1);
  }
  ASSERT_EQ(read(ready[0], &token, 1), 1);
  expect_refused(ErrorCode::conflict, "is held by another cairn-server");
  close(done[1]);
  int status = 0;
  waitpid(holder, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(SqliteStore::open(file_)) << "free again once the holder has ended";
}

TEST_F(Opening, ByAnotherProcessIsRefusedEvenBeforeTheFirstCommit) {
  (void)found();
  const auto store = reopen();
  const int code = in_other_process([this] {
    const auto second = SqliteStore::open(file_);
    return !second && second.error().code == ErrorCode::conflict ? 0 : 1;
  });
  EXPECT_EQ(code, 0);
  EXPECT_TRUE(
      store->commit({.submaps = {sample_submap(1)}, .blocks = {}, .tiles = {}, .notes = {}}));
}

TEST_F(Opening, TwiceInOneProcessIsRefusedAndLeavesTheFirstAlone) {
  const auto store = found();
  expect_refused(ErrorCode::conflict, "is held by another");
  commit(*store, {.submaps = {sample_submap(1)}, .blocks = {}, .tiles = {}, .notes = {}});
  const int code = in_other_process([this] { return SqliteStore::open(file_) ? 1 : 0; });
  EXPECT_EQ(code, 0) << "the lock outlives the refused attempt";
}

TEST_F(Opening, SaysThatThereIsNoSite) { expect_refused(ErrorCode::not_found, "no site file"); }

TEST_F(Opening, RefusesAFileOfANewerVersionUnchanged) {
  (void)found();
  tamper(file_, "PRAGMA user_version = 4");
  const std::string before = content_of(file_);
  expect_refused(ErrorCode::unsupported_version, "format 4, this Cairn knows 3: update Cairn");
  EXPECT_EQ(content_of(file_), before);
}

TEST_F(Opening, BringsAFileOfFormat1UpToDate) {
  SubmapRow kept = sample_submap(1);
  {
    const auto store = found();
    commit(*store, {.submaps = {kept}, .blocks = {}, .tiles = {}, .notes = {}});
  }
  Bytes body = *encode(kept);
  body.resize(body.size() - 5);  // Without edition and link, as format 1 had it.
  const std::uint32_t crc = row_crc(key_of(kept.id), body);
  tamper(file_,
         "DROP TABLE loop; DROP TABLE tried; PRAGMA user_version = 1; UPDATE submap SET body = x'" +
             hex_of(body) + "', crc = " + std::to_string(crc));
  const auto opened = SqliteStore::open(file_);
  ASSERT_TRUE(opened) << opened.error().message;
  const auto submaps = (*opened)->submaps();
  ASSERT_TRUE(submaps) << submaps.error().message;
  ASSERT_EQ(submaps->size(), 1U);
  EXPECT_TRUE(same(submaps->front(), kept));
  EXPECT_TRUE((*opened)->loops()->empty());
  EXPECT_TRUE((*opened)->verify()->faults.empty());
}

TEST_F(Opening, CompressesTheTilesOfAFileOfFormat2AndKeepsThemToTheBit) {
  const TileRow kept = sample_tile({0, 3, -4}, 5);
  {
    const auto store = found();
    commit(*store, {.submaps = {}, .blocks = {}, .tiles = {kept}, .notes = {}});
  }
  Bytes body = *encode(kept);
  const std::size_t small_bytes = body.size();
  body.resize(8);  // After its version the tile as it is in memory, as format 2 had it.
  body.insert(body.end(), kept.tile.bytes().begin(), kept.tile.bytes().end());
  tamper(file_, "PRAGMA user_version = 2; UPDATE tile SET body = x'" + hex_of(body) +
                    "', crc = " + std::to_string(row_crc(key_of(kept.key), body)));
  const auto opened = SqliteStore::open(file_);
  ASSERT_TRUE(opened) << opened.error().message;
  const auto tiles = (*opened)->tiles();
  ASSERT_TRUE(tiles) << tiles.error().message;
  ASSERT_EQ(tiles->size(), 1U);
  EXPECT_EQ(tiles->front().version, kept.version);
  EXPECT_EQ(tiles->front().tile, kept.tile);
  EXPECT_TRUE((*opened)->verify()->faults.empty());
  EXPECT_LT(small_bytes, body.size());
}

TEST_F(Opening, LeavesAnUnsoundTileOfFormat2ForItsReaderToFind) {
  const TileRow kept = sample_tile({0, 3, -4}, 5);
  {
    const auto store = found();
    commit(*store, {.submaps = {}, .blocks = {}, .tiles = {kept}, .notes = {}});
  }
  tamper(file_, "PRAGMA user_version = 2; UPDATE tile SET body = x'0102', crc = 7");
  const auto opened = SqliteStore::open(file_);
  ASSERT_TRUE(opened) << opened.error().message;
  const auto tiles = (*opened)->tiles();
  ASSERT_FALSE(tiles);
  EXPECT_THAT(tiles.error().message, HasSubstr("fails its checksum"));
}

TEST_F(Opening, RefusesGarbageUnchanged) {
  const std::string garbage(10000, 'g');
  write_file(garbage);
  expect_refused(ErrorCode::corrupt, "no Cairn site file");
  EXPECT_EQ(content_of(file_), garbage);
}

TEST_F(Opening, RefusesAnEmptyFileUnchanged) {
  write_file("");
  expect_refused(ErrorCode::corrupt, "no Cairn site file");
  EXPECT_EQ(content_of(file_), "");
}

TEST_F(Opening, RefusesAFolder) {
  std::filesystem::create_directory(file_);
  expect_refused(ErrorCode::corrupt, "is no file");
}

TEST_F(Opening, RefusesADatabaseOfSomebodyElseUnchanged) {
  tamper(file_,
         "PRAGMA journal_mode = WAL; CREATE TABLE theirs (x); INSERT INTO theirs VALUES (1)");
  const std::string before = content_of(file_);
  expect_refused(ErrorCode::corrupt, "no Cairn site file");
  EXPECT_EQ(content_of(file_), before);
}

TEST_F(Opening, RefusesASiteWithoutItsTables) {
  (void)found();
  tamper(file_, "DROP TABLE tile");
  expect_refused(ErrorCode::corrupt, "tables are missing");
}

TEST_F(Opening, RefusesASiteWithoutItsSiteRow) {
  (void)found();
  tamper(file_, "DELETE FROM site");
  expect_refused(ErrorCode::corrupt, "site row is missing");
}

TEST_F(Opening, RefusesATruncatedSite) {
  (void)found();
  std::filesystem::resize_file(file_, 4096);
  expect_refused(ErrorCode::corrupt, "");
}

TEST_F(Opening, FoundingNeverReplacesAFile) {
  write_file("precious");
  const auto store = SqliteStore::create(file_, sample_site());
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::conflict);
  EXPECT_EQ(content_of(file_), "precious");
}

TEST_F(Opening, FoundingRefusesTheLogOfADeletedSite) {
  std::ofstream(file_.string() + "-wal") << "old";
  const auto store = SqliteStore::create(file_, sample_site());
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::conflict);
  EXPECT_THAT(store.error().message, HasSubstr("remove it first"));
}

TEST_F(Opening, FoundingLeavesOneFileAndNothingElse) {
  (void)found();
  const auto entries = std::filesystem::directory_iterator(folder_);
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

TEST_F(Opening, FoundingInAMissingFolderIsAnIoError) {
  const auto store = SqliteStore::create(folder_ / "missing" / "a.cairn", sample_site());
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::io);
  EXPECT_THAT(store.error().message, HasSubstr("folder"));
}

TEST_F(Opening, FoundingInAReadOnlyFolderIsAnIoError) {
  if (geteuid() == 0) GTEST_SKIP() << "skipped: root ignores permissions";
  std::filesystem::permissions(
      folder_, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const auto store = SqliteStore::create(file_, sample_site());
  std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::io);
}

TEST_F(Opening, FoundingRefusesFactsThatCannotBe) {
  for (const int cell_size_mm : {9, 2001}) {
    SiteInfo info = sample_site();
    info.cell_size_mm = cell_size_mm;
    const auto store = SqliteStore::create(file_, info);
    ASSERT_FALSE(store);
    EXPECT_EQ(store.error().code, ErrorCode::invalid_argument);
  }
  SiteInfo nameless = sample_site();
  nameless.name = "Not A Name";
  EXPECT_FALSE(SqliteStore::create(file_, nameless));
}

}  // namespace
}  // namespace cairn::server
