#include <gmock/gmock.h>

#include "tests/unit/server/store/store_fixture.h"

namespace cairn::server {
namespace {

using testing::IsEmpty;
using testing::Not;

/// A table, its column of content, and how many bytes its only row has there.
struct Place {
  const char* table;
  const char* column;
};

class Corruption : public StoreTest, public testing::WithParamInterface<Place> {
 protected:
  void found_small_site() const {
    Transaction small;
    small.submaps = {sample_submap(1)};
    BlockRow block{.id = small.submaps[0].id, .key = {}, .version = 1, .state = {}};
    block.state.changed.set(3);
    block.state.cells[3] = {40, 200};
    small.blocks = {block};
    Tile tile(0);
    tile.set(5, {40, 200});
    small.tiles = {{.key = {}, .version = 1, .tile = PackedTile::pack(tile)}};
    small.loops = {sample_loop(1, 2)};
    small.tried = {{.a = {1, 2}, .b = {1, 3}, .tries = 1, .sigma_m = 0.25}};
    small.notes = {{"note", "value"}};
    commit(*found(), small);
  }
  /// Whether any reading function refuses the file as corrupt.
  static bool reading_fails(Store& store) {
    return !store.submaps() || !store.blocks_of(sample_submap(1).id) || !store.tiles() ||
           !store.loops() || !store.tried() || !store.notes();
  }
};

/// A connection that changes one blob bit by bit.
class Tamperer {
 public:
  Tamperer(const std::filesystem::path& file, const Place& place) {
    EXPECT_EQ(sqlite3_open(file.c_str(), &database_), SQLITE_OK);
    const std::string table = place.table;
    const std::string column = place.column;
    prepare("SELECT " + column + " FROM " + table, read_);
    prepare("UPDATE " + table + " SET " + column + " = ?1", write_);
    sqlite3_exec(database_, "PRAGMA synchronous = OFF", nullptr, nullptr, nullptr);
  }
  ~Tamperer() {
    sqlite3_finalize(read_);
    sqlite3_finalize(write_);
    sqlite3_close(database_);
  }
  Tamperer(const Tamperer&) = delete;
  Tamperer& operator=(const Tamperer&) = delete;

  std::vector<std::uint8_t> read() {
    sqlite3_step(read_);
    const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(read_, 0));
    std::vector<std::uint8_t> bytes(data, data + sqlite3_column_bytes(read_, 0));
    sqlite3_reset(read_);
    return bytes;
  }
  void write(const std::vector<std::uint8_t>& bytes) {
    sqlite3_bind_blob64(write_, 1, bytes.data(), bytes.size(), nullptr);
    EXPECT_EQ(sqlite3_step(write_), SQLITE_DONE);
    sqlite3_reset(write_);
  }

 private:
  void prepare(const std::string& sql, sqlite3_stmt*& statement) {
    EXPECT_EQ(sqlite3_prepare_v2(database_, sql.c_str(), -1, &statement, nullptr), SQLITE_OK);
  }

  sqlite3* database_ = nullptr;
  sqlite3_stmt* read_ = nullptr;
  sqlite3_stmt* write_ = nullptr;
};

TEST_P(Corruption, OfAnySingleBitIsFoundByVerifyAndByReading) {
  found_small_site();
  const auto original = Tamperer(file_, GetParam()).read();
  ASSERT_THAT(original, Not(IsEmpty()));
  for (std::size_t bit = 0; bit < original.size() * 8; ++bit) {
    auto changed = original;
    changed[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    Tamperer(file_, GetParam()).write(changed);
    const auto store = reopen();
    const auto report = store->verify();
    ASSERT_TRUE(report);
    ASSERT_THAT(report->faults, Not(IsEmpty())) << "bit " << bit;
    ASSERT_TRUE(reading_fails(*store)) << "bit " << bit;
  }
  Tamperer(file_, GetParam()).write(original);
  const auto store = reopen();
  EXPECT_THAT(store->verify()->faults, IsEmpty());
  EXPECT_FALSE(reading_fails(*store));
}

INSTANTIATE_TEST_SUITE_P(All, Corruption,
                         testing::Values(Place{"submap", "body"}, Place{"block", "body"},
                                         Place{"tile", "body"}, Place{"loop", "body"},
                                         Place{"tried", "body"}, Place{"note", "value"}),
                         [](const auto& place) { return std::string(place.param.table); });

class CorruptKeys : public Corruption {};

TEST_F(CorruptKeys, OfRowsAreFound) {
  found_small_site();
  for (const char* change :
       {"UPDATE submap SET sequence = sequence + 1", "UPDATE submap SET boot = boot + 1",
        "UPDATE block SET tile = tile + 1", "UPDATE block SET part = part + 1",
        "UPDATE block SET submap = submap + 1", "UPDATE tile SET key = key + 1",
        "UPDATE loop SET to_boot = to_boot + 1", "UPDATE note SET name = name || 'x'",
        "UPDATE tile SET crc = crc + 1"}) {
    const std::string sound = content_of(file_);
    tamper(file_, change);
    const auto report = reopen()->verify();
    ASSERT_TRUE(report);
    EXPECT_THAT(report->faults, Not(IsEmpty())) << change;
    std::ofstream(file_, std::ios::binary) << sound;
  }
}

TEST_F(CorruptKeys, OfTheSiteRowAreFoundByOpening) {
  found_small_site();
  tamper(file_, "UPDATE site SET body = x'00'");
  const auto store = SqliteStore::open(file_);
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::corrupt);
}

TEST_F(CorruptKeys, AMergedSubmapThatLostABlockIsFoundByVerify) {
  SubmapRow merged = sample_submap(1);
  merged.state = SubmapState::merged;
  merged.blocks = 2;
  merged.final_versions = 5 + 6;
  merged.merge_order = 1;
  commit(*found(), {.submaps = {merged},
                    .blocks = {sample_block(merged.id, {EvidenceLayer::surface, {}, 1}, 4),
                               sample_block(merged.id, {EvidenceLayer::surface, {}, 2}, 5)},
                    .tiles = {},
                    .notes = {}});
  EXPECT_THAT(reopen()->verify()->faults, IsEmpty());
  tamper(file_, "DELETE FROM block WHERE part = 2");
  EXPECT_THAT(reopen()->verify()->faults, testing::SizeIs(1));
}

TEST_F(CorruptKeys, ManyFaultsAreListedUpToTheBound) {
  Transaction many;
  many.submaps = {sample_submap(1)};
  for (std::int32_t i = 0; i < 150; ++i) {
    many.blocks.push_back(
        sample_block(many.submaps[0].id, {EvidenceLayer::surface, {0, i, 0}, 0}, 1));
  }
  commit(*found(), many);
  tamper(file_, "UPDATE block SET crc = crc + 1");
  EXPECT_EQ(reopen()->verify()->faults.size(), StoreReport::kMaxFaults);
}

}  // namespace
}  // namespace cairn::server
