#pragma once

#include <filesystem>
#include <memory>

#include "server/store/store.h"

namespace cairn::server {

/// One SQLite file per site (FORMAT.md): WAL, synchronous=FULL, one process at a time.
class SqliteStore {
 public:
  /// Makes a new site file. conflict when it exists; io when the folder cannot be written.
  static Result<std::unique_ptr<Store>> create(const std::filesystem::path& file,
                                               const SiteInfo& info);
  /// Opens an existing one. not_found; conflict when another process holds it; unsupported_version
  /// when a newer Cairn wrote it; corrupt when it is no site file.
  static Result<std::unique_ptr<Store>> open(const std::filesystem::path& file);
};

}  // namespace cairn::server
