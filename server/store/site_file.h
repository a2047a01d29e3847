#pragma once

#include <filesystem>

#include "core/common/result.h"
#include "server/store/sqlite.h"
#include "server/store/store.h"

namespace cairn::server {

/// PRAGMA application_id of every site file: "CRN1".
inline constexpr std::int64_t kSiteFileMagic = 0x43524E31;
/// PRAGMA user_version: the format of FORMAT.md that this Cairn reads and writes.
inline constexpr std::int64_t kSiteFileVersion = 3;

/// Makes the file with its tables and its site row, whole or not at all. Errors as
/// SqliteStore::create.
[[nodiscard]] Status found_site_file(const std::filesystem::path& file, const SiteInfo& info);

/// A connection that holds the file alone, on a format that is ours. Errors as SqliteStore::open.
[[nodiscard]] Result<sqlite::Database> open_site_file(const std::filesystem::path& file);

}  // namespace cairn::server
