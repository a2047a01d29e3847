#include "server/store/sqlite_store.h"

#include "server/store/row_codec.h"
#include "server/store/row_reader.h"
#include "server/store/site_file.h"
#include "server/store/verify.h"

namespace cairn::server {
namespace {

using sqlite::Database;
using sqlite::Statement;

/// Everything the store ever asks, prepared once.
struct Statements {
  Statement begin, commit, rollback;
  Statement put_submap, put_block, put_tile, put_loop, put_tried, put_note, erase_tile;
  Statement row_of_submap, all_submaps, blocks_of_submap, all_tiles, all_loops, all_tried,
      all_notes;
};

Status prepare_all(Database& database, Statements& statements) {
  struct Wanted {
    Statement* statement;
    const char* sql;
  };
  const Wanted all[] = {
      {&statements.begin, "BEGIN IMMEDIATE"},
      {&statements.commit, "COMMIT"},
      {&statements.rollback, "ROLLBACK"},
      {&statements.put_submap,
       "INSERT INTO submap (boot, sequence, body, crc) VALUES (?1, ?2, ?3, ?4) "
       "ON CONFLICT (boot, sequence) DO UPDATE SET body = excluded.body, crc = excluded.crc"},
      {&statements.put_block, "INSERT OR REPLACE INTO block VALUES (?1, ?2, ?3, ?4, ?5)"},
      {&statements.put_tile, "INSERT OR REPLACE INTO tile VALUES (?1, ?2, ?3)"},
      {&statements.put_loop, "INSERT OR REPLACE INTO loop VALUES (?1, ?2, ?3, ?4, ?5, ?6)"},
      {&statements.put_tried, "INSERT OR REPLACE INTO tried VALUES (?1, ?2, ?3, ?4, ?5, ?6)"},
      {&statements.erase_tile, "DELETE FROM tile WHERE key = ?1"},
      {&statements.put_note, "INSERT OR REPLACE INTO note VALUES (?1, ?2, ?3)"},
      {&statements.row_of_submap, "SELECT row FROM submap WHERE boot = ?1 AND sequence = ?2"},
      {&statements.all_submaps, kSelectSubmaps},
      {&statements.blocks_of_submap, kSelectBlocks},
      {&statements.all_tiles, kSelectTiles},
      {&statements.all_loops, kSelectLoops},
      {&statements.all_tried, kSelectTried},
      {&statements.all_notes, kSelectNotes},
  };
  for (const Wanted& wanted : all) {
    auto prepared = database.prepare(wanted.sql);
    if (!prepared) return prepared.error();
    *wanted.statement = std::move(prepared).value();
  }
  return {};
}

class SqliteSite final : public Store {
 public:
  SqliteSite(Database database, Statements statements, SiteInfo info)
      : database_(std::move(database)),
        statements_(std::move(statements)),
        info_(std::move(info)) {}

  [[nodiscard]] const SiteInfo& site() const override { return info_; }
  Status commit(const Transaction& transaction) override;
  Result<std::vector<SubmapRow>> submaps() override;
  Result<std::vector<BlockRow>> blocks_of(const SubmapId& id) override;
  Result<std::vector<TileRow>> tiles() override;
  Result<std::vector<LoopRow>> loops() override;
  Result<std::vector<TriedRow>> tried() override;
  Result<std::map<std::string, std::string>> notes() override;
  Result<StoreReport> verify() override { return verify_rows(database_); }

 private:
  Status write(const Transaction& transaction);
  Status put(const SubmapRow& row);
  Status put(const BlockRow& row);
  Status put(const TileRow& row);
  Status put(const LoopRow& row);
  Status put(const TriedRow& row);
  Status put(const std::pair<const std::string, std::string>& note);
  Result<std::optional<std::int64_t>> row_of(const SubmapId& id);

  Database database_;  // First, so that it closes last.
  Statements statements_;
  SiteInfo info_;
};

Status SqliteSite::commit(const Transaction& transaction) {
  if (transaction.empty()) return {};
  Status done = statements_.begin.run();
  if (done) done = write(transaction);
  if (done) done = statements_.commit.run();
  // Some failures make SQLite roll back by itself.
  if (!done && database_.in_transaction()) (void)statements_.rollback.run();
  return done;
}

Status SqliteSite::write(const Transaction& transaction) {
  const auto put_each = [this](const auto& rows) -> Status {
    for (const auto& row : rows) {
      if (auto done = put(row); !done) return done;
    }
    return {};
  };
  Status done = put_each(transaction.submaps);
  if (done) done = put_each(transaction.blocks);
  for (const TileKey& key : transaction.erased_tiles) {
    if (done) done = statements_.erase_tile.bind(1, pack(key)).run();
  }
  if (done) done = put_each(transaction.tiles);
  if (done) done = put_each(transaction.loops);
  if (done) done = put_each(transaction.tried);
  if (done) done = put_each(transaction.notes);
  return done;
}

Status SqliteSite::put(const SubmapRow& row) {
  const auto body = encode(row);
  if (!body) return body.error();
  return statements_.put_submap.bind(1, static_cast<std::int64_t>(row.id.boot))
      .bind(2, std::int64_t{row.id.sequence})
      .bind(3, ByteSpan(*body))
      .bind(4, std::int64_t{row_crc(key_of(row.id), *body)})
      .run();
}

Status SqliteSite::put(const BlockRow& row) {
  const auto body = encode(row);
  if (!body) return body.error();
  const auto submap = row_of(row.id);
  if (!submap) return submap.error();
  if (!submap->has_value()) {
    return Error{ErrorCode::invalid_argument,
                 "a block of " + submap_name(row.id) + " cannot be stored before its submap"};
  }
  return statements_.put_block.bind(1, **submap)
      .bind(2, pack(row.key.tile))
      .bind(3, pack_part(row.key))
      .bind(4, ByteSpan(*body))
      .bind(5, std::int64_t{row_crc(key_of(row.id, row.key), *body)})
      .run();
}

Status SqliteSite::put(const TileRow& row) {
  const auto body = encode(row);
  if (!body) return body.error();
  return statements_.put_tile.bind(1, pack(row.key))
      .bind(2, ByteSpan(*body))
      .bind(3, std::int64_t{row_crc(key_of(row.key), *body)})
      .run();
}

Status put_pair(Statement& statement, char kind, const SubmapId& from, const SubmapId& to,
                const Bytes& body) {
  return statement.bind(1, static_cast<std::int64_t>(from.boot))
      .bind(2, std::int64_t{from.sequence})
      .bind(3, static_cast<std::int64_t>(to.boot))
      .bind(4, std::int64_t{to.sequence})
      .bind(5, ByteSpan(body))
      .bind(6, std::int64_t{row_crc(key_of(kind, from, to), body)})
      .run();
}

Status SqliteSite::put(const LoopRow& row) {
  const auto body = encode(row);
  if (!body) return body.error();
  return put_pair(statements_.put_loop, 'L', row.from, row.to, *body);
}

Status SqliteSite::put(const TriedRow& row) {
  const auto body = encode(row);
  if (!body) return body.error();
  return put_pair(statements_.put_tried, 'C', row.a, row.b, *body);
}

Status SqliteSite::put(const std::pair<const std::string, std::string>& note) {
  const auto& [name, value] = note;
  if (auto bounded = check_note(name, value); !bounded) return bounded;
  const Bytes body(value.begin(), value.end());
  return statements_.put_note.bind(1, std::string_view(name))
      .bind(2, ByteSpan(body))
      .bind(3, std::int64_t{row_crc(key_of_note(name), body)})
      .run();
}

Result<std::optional<std::int64_t>> SqliteSite::row_of(const SubmapId& id) {
  Statement& find = statements_.row_of_submap;
  find.bind(1, static_cast<std::int64_t>(id.boot)).bind(2, std::int64_t{id.sequence});
  const auto found = find.step();
  if (!found) return found.error();
  if (!*found) return std::optional<std::int64_t>();
  const std::int64_t row = find.integer(0);
  find.reset();
  return std::optional(row);
}

/// Reads all rows of a statement, up to the first that is not sound.
template <class Read>
auto read_all(Statement& rows, const Read& read)
    -> Result<std::vector<std::decay_t<decltype(read(rows).value())>>> {
  std::vector<std::decay_t<decltype(read(rows).value())>> all;
  for (;;) {
    const auto row = rows.step();
    if (!row) return row.error();
    if (!*row) return all;
    auto value = read(rows);
    if (!value) {
      rows.reset();
      return value.error();
    }
    all.push_back(std::move(value).value());
  }
}

Result<std::vector<SubmapRow>> SqliteSite::submaps() {
  return read_all(statements_.all_submaps, read_submap);
}

Result<std::vector<BlockRow>> SqliteSite::blocks_of(const SubmapId& id) {
  const auto row = row_of(id);
  if (!row) return row.error();
  if (!row->has_value()) return std::vector<BlockRow>();
  return read_all(statements_.blocks_of_submap.bind(1, **row),
                  [&](const Statement& block) { return read_block(block, id); });
}

Result<std::vector<TileRow>> SqliteSite::tiles() {
  return read_all(statements_.all_tiles, read_tile);
}

Result<std::vector<LoopRow>> SqliteSite::loops() {
  return read_all(statements_.all_loops, read_loop);
}

Result<std::vector<TriedRow>> SqliteSite::tried() {
  return read_all(statements_.all_tried, read_tried);
}

Result<std::map<std::string, std::string>> SqliteSite::notes() {
  auto all = read_all(statements_.all_notes, read_note);
  if (!all) return all.error();
  return std::map<std::string, std::string>(all->begin(), all->end());
}

Result<SiteInfo> only_site(Database& database) {
  auto statement = database.prepare(kSelectSite);
  if (!statement) return statement.error();
  const auto row = statement->step();
  if (!row) return row.error();
  if (!*row) return Error{ErrorCode::corrupt, "the site row is missing"};
  return read_site(*statement);
}

}  // namespace

Result<std::unique_ptr<Store>> SqliteStore::create(const std::filesystem::path& file,
                                                   const SiteInfo& info) {
  if (auto founded = found_site_file(file, info); !founded) return founded.error();
  return open(file);
}

Result<std::unique_ptr<Store>> SqliteStore::open(const std::filesystem::path& file) {
  auto database = open_site_file(file);
  if (!database) return database.error();
  Statements statements;
  if (auto prepared = prepare_all(*database, statements); !prepared) {
    return Error{ErrorCode::corrupt, "tables are missing: " + prepared.error().message};
  }
  const auto info = only_site(*database);
  if (!info) return info.error();
  return std::unique_ptr<Store>(
      std::make_unique<SqliteSite>(std::move(database).value(), std::move(statements), *info));
}

}  // namespace cairn::server
