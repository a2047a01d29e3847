#pragma once

#include "core/common/result.h"
#include "server/store/sqlite.h"
#include "server/store/store.h"

namespace cairn::server {

/// Reads all that the file holds and lists what is wrong: SQLite's own integrity check, each row's
/// checksum and bounds, blocks without a submap, merged submaps without all their blocks.
[[nodiscard]] Result<StoreReport> verify_rows(sqlite::Database& database);

}  // namespace cairn::server
