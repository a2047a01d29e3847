#include "server/store/verify.h"

#include "server/store/row_codec.h"
#include "server/store/row_reader.h"

namespace cairn::server {
namespace {

void add_fault(StoreReport& report, std::string fault) {
  if (report.faults.size() < StoreReport::kMaxFaults) report.faults.push_back(std::move(fault));
}

// Shows each row to `look`. A page that SQLite cannot read is one fault and ends the table.
template <class Look>
void look_at_each(StoreReport& report, sqlite::Statement& rows, const Look& look) {
  for (;;) {
    const auto row = rows.step();
    if (!row) return add_fault(report, row.error().message);
    if (!*row) return;
    look(rows);
  }
}

template <class Look>
void look_at_all(StoreReport& report, sqlite::Database& database, const char* sql,
                 const Look& look) {
  auto rows = database.prepare(sql);
  if (!rows) return add_fault(report, rows.error().message);
  look_at_each(report, *rows, look);
}

template <class T>
void note_fault(StoreReport& report, const Result<T>& read) {
  if (!read) add_fault(report, read.error().message);
}

void check_integrity(StoreReport& report, sqlite::Database& database) {
  look_at_all(report, database, "PRAGMA integrity_check(100)", [&](const sqlite::Statement& row) {
    if (row.text(0) != "ok") add_fault(report, "SQLite: " + std::string(row.text(0)));
  });
}

// A merged submap was complete when it was folded: what is missing now was lost.
void check_complete(StoreReport& report, const SubmapRow& submap, std::uint64_t blocks,
                    std::uint64_t versions) {
  if (submap.state != SubmapState::merged) return;
  if (blocks == submap.blocks && versions == submap.final_versions) return;
  add_fault(report, submap_name(submap.id) + " was merged with " + std::to_string(submap.blocks) +
                        " blocks, but holds " + std::to_string(blocks) + " or other versions");
}

void check_blocks_of(StoreReport& report, sqlite::Statement& rows, const SubmapRow& submap) {
  std::uint64_t blocks = 0;
  std::uint64_t versions = 0;
  look_at_each(report, rows, [&](const sqlite::Statement& row) {
    const auto block = read_block(row, submap.id);
    note_fault(report, block);
    ++blocks;
    if (block) versions += block->version;
  });
  report.blocks += blocks;
  check_complete(report, submap, blocks, versions);
}

// The row number comes last, so that read_submap finds its columns where it expects them.
constexpr const char* kSelectSubmapsWithRow = "SELECT boot, sequence, body, crc, row FROM submap";

void check_submaps(StoreReport& report, sqlite::Database& database) {
  auto blocks = database.prepare(kSelectBlocks);
  if (!blocks) return add_fault(report, blocks.error().message);
  look_at_all(report, database, kSelectSubmapsWithRow, [&](const sqlite::Statement& row) {
    ++report.submaps;
    const auto submap = read_submap(row);
    note_fault(report, submap);
    SubmapRow known{};
    known.id = {static_cast<std::uint64_t>(row.integer(0)),
                static_cast<std::uint32_t>(row.integer(1))};
    blocks->bind(1, row.integer(4));
    check_blocks_of(report, *blocks, submap ? *submap : known);
  });
}

void check_orphans(StoreReport& report, sqlite::Database& database) {
  const auto orphans = database.query_integer(
      "SELECT count(*) FROM block WHERE submap NOT IN (SELECT row FROM submap)");
  note_fault(report, orphans);
  if (orphans && *orphans != 0) {
    add_fault(report, std::to_string(*orphans) + " blocks belong to no submap");
  }
}

}  // namespace

Result<StoreReport> verify_rows(sqlite::Database& database) {
  StoreReport report;
  check_integrity(report, database);
  look_at_all(report, database, kSelectSite,
              [&](const sqlite::Statement& row) { note_fault(report, read_site(row)); });
  check_submaps(report, database);
  check_orphans(report, database);
  look_at_all(report, database, kSelectTiles, [&](const sqlite::Statement& row) {
    ++report.tiles;
    note_fault(report, read_tile(row));
  });
  look_at_all(report, database, kSelectLoops, [&](const sqlite::Statement& row) {
    ++report.loops;
    note_fault(report, read_loop(row));
  });
  look_at_all(report, database, kSelectTried,
              [&](const sqlite::Statement& row) { note_fault(report, read_tried(row)); });
  look_at_all(report, database, kSelectNotes,
              [&](const sqlite::Statement& row) { note_fault(report, read_note(row)); });
  return report;
}

}  // namespace cairn::server
