#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/common/result.h"

/// SQLite's C API as values that clean up after themselves.
namespace cairn::server::sqlite {

/// A prepared statement. Parameters count from 1, columns from 0.
class Statement {
 public:
  Statement() = default;

  /// Bound bytes and text must live until the statement has run.
  Statement& bind(int parameter, std::int64_t value);
  Statement& bind(int parameter, std::span<const std::uint8_t> bytes);
  Statement& bind(int parameter, std::string_view text);

  /// True: a row is here. False: the statement has finished and can be bound and run again; so it
  /// is after an error.
  Result<bool> step();
  /// Runs to the end, for statements whose rows do not matter.
  Status run();
  void reset();

  [[nodiscard]] std::int64_t integer(int column) const;
  /// Valid until the next step.
  [[nodiscard]] std::span<const std::uint8_t> bytes(int column) const;
  [[nodiscard]] std::string_view text(int column) const;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  explicit Statement(sqlite3_stmt* statement) : statement_(statement) {}

  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// A connection. Statements must not outlive it.
class Database {
 public:
  enum class Mode { existing, create };
  /// conflict, corrupt or io as `error_of` says.
  static Result<Database> open(const std::filesystem::path& file, Mode mode);

  Result<Statement> prepare(const char* sql);
  Status execute(const char* sql);
  /// The first column of the first row.
  Result<std::int64_t> query_integer(const char* sql);
  /// Whether a transaction is open.
  [[nodiscard]] bool in_transaction() const;
  [[nodiscard]] bool read_only() const;
  /// One of SQLite's on/off switches (SQLITE_DBCONFIG_…).
  void set(int option, bool on);

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
  };
  explicit Database(sqlite3* database) : database_(database) {}

  std::unique_ptr<sqlite3, Close> database_;
};

/// Our error for the connection's last failure: conflict when locked, corrupt when no or a damaged
/// database, io for a full disk and all the rest.
[[nodiscard]] Error error_of(sqlite3* database, int code);

}  // namespace cairn::server::sqlite
