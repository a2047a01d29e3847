#pragma once

#include <string>
#include <utility>

#include "core/common/result.h"
#include "server/store/sqlite.h"
#include "server/store/store.h"

/// Rows out of the statements below, each checked: checksum first, then every bound. An error is
/// corrupt and names the row.
namespace cairn::server {

inline constexpr const char* kSelectSite = "SELECT body, crc FROM site";
inline constexpr const char* kSelectSubmaps =
    "SELECT boot, sequence, body, crc FROM submap ORDER BY row";
/// Blocks of submap row ?1.
inline constexpr const char* kSelectBlocks =
    "SELECT tile, part, body, crc FROM block WHERE submap = ?1 ORDER BY tile, part";
inline constexpr const char* kSelectTiles = "SELECT key, body, crc FROM tile ORDER BY key";
inline constexpr const char* kSelectLoops =
    "SELECT from_boot, from_sequence, to_boot, to_sequence, body, crc FROM loop";
inline constexpr const char* kSelectTried =
    "SELECT from_boot, from_sequence, to_boot, to_sequence, body, crc FROM tried";
inline constexpr const char* kSelectNotes = "SELECT name, value, crc FROM note ORDER BY name";

[[nodiscard]] Result<SiteInfo> read_site(const sqlite::Statement& row);
[[nodiscard]] Result<SubmapRow> read_submap(const sqlite::Statement& row);
[[nodiscard]] Result<BlockRow> read_block(const sqlite::Statement& row, const SubmapId& id);
[[nodiscard]] Result<TileRow> read_tile(const sqlite::Statement& row);
[[nodiscard]] Result<LoopRow> read_loop(const sqlite::Statement& row);
[[nodiscard]] Result<TriedRow> read_tried(const sqlite::Statement& row);
[[nodiscard]] Result<std::pair<std::string, std::string>> read_note(const sqlite::Statement& row);

}  // namespace cairn::server
