#include "server/store/upgrade.h"

#include <utility>
#include <vector>

#include "core/map/packed_tile.h"
#include "proto/codec/tile_snapshot.h"
#include "server/store/row_codec.h"

namespace cairn::server {
namespace {

constexpr const char* kPairTables = R"sql(
CREATE TABLE loop (from_boot INTEGER NOT NULL, from_sequence INTEGER NOT NULL,
                   to_boot INTEGER NOT NULL, to_sequence INTEGER NOT NULL, body BLOB NOT NULL,
                   crc INTEGER NOT NULL,
                   PRIMARY KEY (from_boot, from_sequence, to_boot, to_sequence)) WITHOUT ROWID;
CREATE TABLE tried (from_boot INTEGER NOT NULL, from_sequence INTEGER NOT NULL,
                    to_boot INTEGER NOT NULL, to_sequence INTEGER NOT NULL, body BLOB NOT NULL,
                    crc INTEGER NOT NULL,
                    PRIMARY KEY (from_boot, from_sequence, to_boot, to_sequence)) WITHOUT ROWID;
)sql";

struct RawSubmap {
  std::int64_t row = 0;
  SubmapId id;
  Bytes body;
};

/// The submap rows that are sound.
Result<std::vector<RawSubmap>> sound_submaps(sqlite::Database& database) {
  auto rows = database.prepare("SELECT row, boot, sequence, body, crc FROM submap");
  if (!rows) return rows.error();
  std::vector<RawSubmap> all;
  for (;;) {
    const auto row = rows->step();
    if (!row) return row.error();
    if (!*row) return all;
    const ByteSpan body = rows->bytes(3);
    RawSubmap submap{rows->integer(0),
                     {static_cast<std::uint64_t>(rows->integer(1)),
                      static_cast<std::uint32_t>(rows->integer(2))},
                     Bytes(body.begin(), body.end())};
    if (rows->integer(4) == std::int64_t{row_crc(key_of(submap.id), submap.body)}) {
      all.push_back(std::move(submap));
    }
  }
}

/// Format 1 knew neither editions nor links.
Status submaps_from_1_to_2(sqlite::Database& database) {
  auto submaps = sound_submaps(database);
  if (!submaps) return submaps.error();
  auto update = database.prepare("UPDATE submap SET body = ?2, crc = ?3 WHERE row = ?1");
  if (!update) return update.error();
  for (RawSubmap& submap : *submaps) {
    submap.body.insert(submap.body.end(), 5, 0);  // Edition 0, no link.
    Status done = update->bind(1, submap.row)
                      .bind(2, ByteSpan(submap.body))
                      .bind(3, std::int64_t{row_crc(key_of(submap.id), submap.body)})
                      .run();
    if (!done) return done;
  }
  return {};
}

Status from_1_to_2(sqlite::Database& database) {
  Status done = database.execute(kPairTables);
  if (done) done = submaps_from_1_to_2(database);
  if (done) done = database.execute("PRAGMA user_version = 2");
  return done;
}

struct RawTile {
  std::int64_t packed_key = 0;
  Bytes body;
};

/// The tile rows that are sound.
Result<std::vector<RawTile>> sound_tiles(sqlite::Database& database) {
  auto rows = database.prepare("SELECT key, body, crc FROM tile");
  if (!rows) return rows.error();
  std::vector<RawTile> all;
  for (;;) {
    const auto row = rows->step();
    if (!row) return row.error();
    if (!*row) return all;
    const ByteSpan body = rows->bytes(1);
    RawTile tile{rows->integer(0), Bytes(body.begin(), body.end())};
    const Bytes key = key_of(unpack_tile(tile.packed_key));
    if (rows->integer(2) == std::int64_t{row_crc(key, tile.body)}) all.push_back(std::move(tile));
  }
}

/// A tile's body as format 3 has it; as it was when it is no body of format 2.
Bytes compressed(const Bytes& body) {
  constexpr std::size_t kVersionBytes = 8;
  if (body.size() < kVersionBytes) return body;
  const auto tile = PackedTile::from_bytes(ByteSpan(body).subspan(kVersionBytes));
  if (!tile) return body;
  Bytes small(body.begin(), body.begin() + kVersionBytes);
  const Bytes snapshot = proto::write_tile_snapshot(*tile);
  small.insert(small.end(), snapshot.begin(), snapshot.end());
  return small;
}

/// Format 2 held tiles as they are in memory.
Status from_2_to_3(sqlite::Database& database) {
  const auto tiles = sound_tiles(database);
  if (!tiles) return tiles.error();
  auto update = database.prepare("UPDATE tile SET body = ?2, crc = ?3 WHERE key = ?1");
  if (!update) return update.error();
  for (const RawTile& tile : *tiles) {
    const Bytes body = compressed(tile.body);
    const Bytes key = key_of(unpack_tile(tile.packed_key));
    Status done = update->bind(1, tile.packed_key)
                      .bind(2, ByteSpan(body))
                      .bind(3, std::int64_t{row_crc(key, body)})
                      .run();
    if (!done) return done;
  }
  return database.execute("PRAGMA user_version = 3");
}

}  // namespace

Status bring_up_to_date(sqlite::Database& database) {
  const auto version = database.query_integer("PRAGMA user_version");
  if (!version) return version.error();
  if (*version > 2) return {};
  if (Status begun = database.execute("BEGIN IMMEDIATE"); !begun) return begun;
  Status done = *version == 1 ? from_1_to_2(database) : Status();
  if (done) done = from_2_to_3(database);
  if (done) done = database.execute("COMMIT");
  if (!done && database.in_transaction()) (void)database.execute("ROLLBACK");
  return done;
}

}  // namespace cairn::server
