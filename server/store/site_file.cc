#include "server/store/site_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "server/store/row_codec.h"
#include "server/store/upgrade.h"

namespace cairn::server {
namespace {

namespace fs = std::filesystem;

/// Of format 1: founding brings it up to date like any other.
constexpr const char* kSchema = R"sql(
PRAGMA page_size = 4096;
BEGIN;
CREATE TABLE site (id INTEGER PRIMARY KEY CHECK (id = 1), body BLOB NOT NULL, crc INTEGER NOT NULL);
CREATE TABLE submap (row INTEGER PRIMARY KEY, boot INTEGER NOT NULL, sequence INTEGER NOT NULL,
                     body BLOB NOT NULL, crc INTEGER NOT NULL, UNIQUE (boot, sequence));
CREATE TABLE block (submap INTEGER NOT NULL, tile INTEGER NOT NULL, part INTEGER NOT NULL,
                    body BLOB NOT NULL, crc INTEGER NOT NULL, PRIMARY KEY (submap, tile, part))
                    WITHOUT ROWID;
CREATE TABLE tile (key INTEGER PRIMARY KEY, body BLOB NOT NULL, crc INTEGER NOT NULL);
CREATE TABLE note (name TEXT PRIMARY KEY, value BLOB NOT NULL, crc INTEGER NOT NULL) WITHOUT ROWID;
PRAGMA application_id = 0x43524E31;
PRAGMA user_version = 1;
COMMIT;
)sql";

Error io_error(const fs::path& file, const std::string& could_not) {
  return {ErrorCode::io, could_not + " " + file.string() + ": " + std::strerror(errno) +
                             "; check that the folder exists, is writable and has room"};
}

Error exists_error(const fs::path& file) {
  return {ErrorCode::conflict,
          file.string() + " exists: open that site, or found the new one under another name"};
}

Status sync(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return io_error(path, "cannot open");
  const bool synced = fsync(fd) == 0;
  Status status = synced ? Status() : Status(io_error(path, "cannot sync"));
  ::close(fd);
  return status;
}

fs::path folder_of(const fs::path& file) { return fs::absolute(file).parent_path(); }

// A log left behind by a deleted site would be replayed into the new one.
Status check_free(const fs::path& file) {
  std::error_code ignored;
  if (fs::exists(file, ignored)) return exists_error(file);
  for (const char* suffix : {"-wal", "-journal"}) {
    const fs::path log = file.string() + suffix;
    if (!fs::exists(log, ignored)) continue;
    return Error{ErrorCode::conflict,
                 log.string() + " is left over from a site that is gone: remove it first"};
  }
  return {};
}

// All is in the main file when this returns: closing folds the log in and removes it.
Status write_empty_site(const fs::path& file, const Bytes& site_body) {
  auto database = sqlite::Database::open(file, sqlite::Database::Mode::create);
  if (!database) return database.error();
  for (const char* sql : {"PRAGMA synchronous = FULL", kSchema, "PRAGMA journal_mode = WAL"}) {
    if (auto done = database->execute(sql); !done) return done;
  }
  if (auto current = bring_up_to_date(*database); !current) return current;
  auto insert = database->prepare("INSERT INTO site VALUES (1, ?1, ?2)");
  if (!insert) return insert.error();
  return insert->bind(1, ByteSpan(site_body))
      .bind(2, std::int64_t{row_crc(site_key(), site_body)})
      .run();
}

// Gives the finished file its name, unless somebody was quicker.
Status publish(const fs::path& made, const fs::path& file) {
  if (auto synced = sync(made); !synced) return synced;
  if (renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, file.c_str(), RENAME_NOREPLACE) != 0) {
    if (errno == EEXIST) return exists_error(file);
    return io_error(file, "cannot make");
  }
  return sync(folder_of(file));
}

void remove_all_of(const fs::path& file) {
  std::error_code ignored;
  for (const char* suffix : {"", "-wal", "-journal", "-shm"}) {
    fs::remove(file.string() + suffix, ignored);
  }
}

Status check_format(sqlite::Database& database, const fs::path& file) {
  const auto magic = database.query_integer("PRAGMA application_id");
  if (!magic) return magic.error();
  if (*magic != kSiteFileMagic) {
    return Error{ErrorCode::corrupt, file.string() + " is no Cairn site file"};
  }
  const auto version = database.query_integer("PRAGMA user_version");
  if (!version) return version.error();
  if (*version > kSiteFileVersion) {
    return Error{ErrorCode::unsupported_version,
                 file.string() + " has format " + std::to_string(*version) + ", this Cairn knows " +
                     std::to_string(kSiteFileVersion) + ": update Cairn to open it"};
  }
  if (*version < 1) return Error{ErrorCode::corrupt, file.string() + " has no format version"};
  return {};
}

}  // namespace

Status found_site_file(const fs::path& file, const SiteInfo& info) {
  const auto body = encode(info);
  if (!body) return body.error();
  if (auto free = check_free(file); !free) return free;
  const fs::path made = file.string() + ".founding-" + std::to_string(getpid());
  remove_all_of(made);
  Status done = write_empty_site(made, *body);
  if (done) done = publish(made, file);
  if (!done) remove_all_of(made);
  return done;
}

Result<sqlite::Database> open_site_file(const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    return Error{ErrorCode::not_found,
                 "there is no site file " + file.string() + ": check --data or found a new site"};
  }
  if (!fs::is_regular_file(file, ignored)) {
    return Error{ErrorCode::corrupt, file.string() + " is no file: check --data"};
  }
  auto database = sqlite::Database::open(file, sqlite::Database::Mode::existing);
  if (!database) return database.error();
  if (database->read_only()) {
    return Error{ErrorCode::io, file.string() + " may not be written: check who owns it"};
  }
  // Until we know it is ours, closing must not touch it.
  database->set(SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, true);
  database->set(SQLITE_DBCONFIG_DEFENSIVE, true);
  database->set(SQLITE_DBCONFIG_TRUSTED_SCHEMA, false);
  // Set before the first read, the lock is taken with that read and kept.
  if (auto alone = database->execute("PRAGMA locking_mode = EXCLUSIVE"); !alone) {
    return alone.error();
  }
  if (auto ours = check_format(*database, file); !ours) return ours.error();
  for (const char* sql :
       {"PRAGMA journal_mode = WAL", "PRAGMA synchronous = FULL", "PRAGMA cell_size_check = ON"}) {
    if (auto done = database->execute(sql); !done) return done.error();
  }
  if (auto current = bring_up_to_date(*database); !current) return current.error();
  database->set(SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, false);
  return database;
}

}  // namespace cairn::server
