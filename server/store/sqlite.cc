#include "server/store/sqlite.h"

namespace cairn::server::sqlite {
namespace {

// A null pointer would bind NULL instead of nothing.
constexpr std::uint8_t kNothing = 0;

std::string path_of(sqlite3* database) {
  const char* name = database == nullptr ? nullptr : sqlite3_db_filename(database, "main");
  return name == nullptr ? "site file" : name;
}

}  // namespace

Error error_of(sqlite3* database, int code) {
  const std::string file = path_of(database);
  const std::string why = database == nullptr ? sqlite3_errstr(code) : sqlite3_errmsg(database);
  switch (code & 0xFF) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {ErrorCode::conflict,
              file + " is held by another cairn-server: stop it or use another --data"};
    case SQLITE_NOTADB:
      return {ErrorCode::corrupt, file + " is no Cairn site file"};
    case SQLITE_CORRUPT:
      return {ErrorCode::corrupt,
              file + " is damaged (" + why + "): stop and restore it from a backup"};
    case SQLITE_FULL:
      return {ErrorCode::io,
              "no room left for " + file +
                  ": nothing of this step was kept; free disk space, then it goes on"};
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      return {ErrorCode::io, file + " cannot be opened for writing (" + why +
                                 "): check that its folder exists and who owns both"};
    default:
      return {ErrorCode::io,
              file + ": " + why + " (SQLite code " + std::to_string(code) +
                  "); nothing of this step was kept: check the disk, then it goes on"};
  }
}

Statement& Statement::bind(int parameter, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), parameter, value);
  return *this;
}

Statement& Statement::bind(int parameter, std::span<const std::uint8_t> bytes) {
  const std::uint8_t* data = bytes.empty() ? &kNothing : bytes.data();
  sqlite3_bind_blob64(statement_.get(), parameter, data, bytes.size(), nullptr);
  return *this;
}

Statement& Statement::bind(int parameter, std::string_view text) {
  const char* data = text.empty() ? "" : text.data();
  sqlite3_bind_text64(statement_.get(), parameter, data, text.size(), nullptr, SQLITE_UTF8);
  return *this;
}

Result<bool> Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) {
    reset();
    return false;
  }
  Error error = error_of(sqlite3_db_handle(statement_.get()), code);
  reset();
  return error;
}

Status Statement::run() {
  for (;;) {
    const auto row = step();
    if (!row) return row.error();
    if (!*row) return {};
  }
}

void Statement::reset() { sqlite3_reset(statement_.get()); }

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

std::span<const std::uint8_t> Statement::bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  if (data == nullptr) return {};
  return {static_cast<const std::uint8_t*>(data), static_cast<std::size_t>(size)};
}

std::string_view Statement::text(int column) const {
  const auto raw = bytes(column);
  return {reinterpret_cast<const char*>(raw.data()), raw.size()};
}

Result<Database> Database::open(const std::filesystem::path& file, Mode mode) {
  sqlite3* handle = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_EXRESCODE |
                    (mode == Mode::create ? SQLITE_OPEN_CREATE : 0);
  // Absolute, because SQLite gives some names (":memory:") a meaning of their own.
  const int code =
      sqlite3_open_v2(std::filesystem::absolute(file).c_str(), &handle, flags, nullptr);
  Database database(handle);  // Also a connection that failed must be closed.
  if (code != SQLITE_OK) return error_of(handle, code);
  return database;
}

Result<Statement> Database::prepare(const char* sql) {
  sqlite3_stmt* statement = nullptr;
  const int code =
      sqlite3_prepare_v3(database_.get(), sql, -1, SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  if (code != SQLITE_OK) return error_of(database_.get(), code);
  return Statement(statement);
}

Status Database::execute(const char* sql) {
  const int code = sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) return error_of(database_.get(), code);
  return {};
}

Result<std::int64_t> Database::query_integer(const char* sql) {
  auto statement = prepare(sql);
  if (!statement) return statement.error();
  const auto row = statement->step();
  if (!row) return row.error();
  return *row ? statement->integer(0) : 0;
}

bool Database::in_transaction() const { return sqlite3_get_autocommit(database_.get()) == 0; }

bool Database::read_only() const { return sqlite3_db_readonly(database_.get(), "main") == 1; }

void Database::set(int option, bool on) {
  sqlite3_db_config(database_.get(), option, on ? 1 : 0, nullptr);
}

}  // namespace cairn::server::sqlite
