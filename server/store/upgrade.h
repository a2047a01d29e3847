#pragma once

#include "core/common/result.h"
#include "server/store/sqlite.h"

namespace cairn::server {

/// Brings a site file of an older format to kSiteFileVersion, whole or not at all. Rows that fail
/// their checksum stay as they are: reading them says so. Does nothing to a file of today's format.
[[nodiscard]] Status bring_up_to_date(sqlite::Database& database);

}  // namespace cairn::server
