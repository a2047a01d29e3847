#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>

#include "server/store/sqlite_store.h"

/// What the tests of the store share.
namespace cairn::server {

inline SiteInfo sample_site() {
  return {.name = "quarry", .epoch = 0xFEDCBA9876543210, .cell_size_mm = 125, .founded_unix_s = 17};
}

inline SubmapRow sample_submap(std::uint32_t sequence) {
  SubmapRow row;
  row.id = {0xF00D000000000001, sequence};
  row.robot = "rover-1";
  row.head_version = 3;
  row.T_site_submap = {-1000, 2000, -30, -31416};
  return row;
}

/// A block whose cells follow from `seed`; a third of them are known.
inline BlockRow sample_block(const SubmapId& id, const BlockKey& key, std::uint32_t seed) {
  std::mt19937 random(seed);
  BlockRow row{.id = id, .key = key, .version = seed + 1, .state = {}};
  row.state.datum_mm = static_cast<std::int32_t>(random() % 100000) - 50000;
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    if (random() % 3 != 0) continue;
    row.state.changed.set(i);
    const auto offset_mm = static_cast<std::int32_t>(random() % 65535) - 32767;
    row.state.cells[i] = {row.state.datum_mm + offset_mm,
                          static_cast<std::uint8_t>(1 + random() % 255)};
  }
  return row;
}

inline TileRow sample_tile(const TileKey& key, std::uint32_t seed) {
  std::mt19937 random(seed);
  Tile tile(1200);
  for (int i = 0; i < 200; ++i) {
    tile.set(static_cast<int>(random() % Tile::kCells),
             {1200 + static_cast<std::int32_t>(random() % 2000), 77});
  }
  return {.key = key, .version = seed + 1, .tile = PackedTile::pack(tile)};
}

inline LoopRow sample_loop(std::uint32_t from, std::uint32_t to) {
  return {.from = sample_submap(from).id,
          .to = sample_submap(to).id,
          .status = 1,
          .T_from_to = {1.5, -2.25, 0.01, 3.0},
          .information = {1, 2, 3, 4, 5, 6, 7, 8, 9, 1e9}};
}

inline bool same(const LoopRow& a, const LoopRow& b) {
  return a.from == b.from && a.to == b.to && a.status == b.status && a.T_from_to == b.T_from_to &&
         a.information == b.information;
}

inline bool same(const SubmapRow& a, const SubmapRow& b) {
  return a.id == b.id && a.robot == b.robot && a.head_version == b.head_version &&
         a.T_site_submap == b.T_site_submap && a.state == b.state && a.blocks == b.blocks &&
         a.final_versions == b.final_versions && a.merge_order == b.merge_order &&
         a.edition == b.edition && a.link == b.link;
}

inline bool same(const BlockRow& a, const BlockRow& b) {
  return a.id == b.id && a.key == b.key && a.version == b.version &&
         a.state.datum_mm == b.state.datum_mm && a.state.changed == b.state.changed &&
         a.state.cells == b.state.cells;
}

inline bool same(const TileRow& a, const TileRow& b) {
  return a.key == b.key && a.version == b.version && a.tile == b.tile;
}

inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// Changes the file behind the store's back. Requires: no store has it open.
inline void tamper(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  char* message = nullptr;
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &message), SQLITE_OK) << message;
  sqlite3_free(message);
  sqlite3_close(database);
}

/// A folder of its own for each test, removed at the end.
class StoreTest : public testing::Test {
 protected:
  StoreTest() {
    std::string pattern = testing::TempDir() + "cairn-store-XXXXXX";
    folder_ = mkdtemp(pattern.data());
    file_ = folder_ / "quarry.cairn";
  }
  ~StoreTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  [[nodiscard]] std::unique_ptr<Store> found() const {
    auto store = SqliteStore::create(file_, sample_site());
    EXPECT_TRUE(store) << store.error().message;
    return std::move(store).value();
  }
  [[nodiscard]] std::unique_ptr<Store> reopen() const {
    auto store = SqliteStore::open(file_);
    EXPECT_TRUE(store) << store.error().message;
    return std::move(store).value();
  }
  static void commit(Store& store, const Transaction& transaction) {
    const Status done = store.commit(transaction);
    ASSERT_TRUE(done) << done.error().message;
  }

  std::filesystem::path folder_;
  std::filesystem::path file_;
};

}  // namespace cairn::server
