#include "robot_agent/spool/spool_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>

namespace cairn::agent {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHalfWritten = "half-written";
constexpr const char* kLock = "lock";

Error io_error(const std::string& what, const fs::path& path, int number) {
  return {ErrorCode::io, what + " " + path.string() + ": " + std::strerror(number)};
}

std::string text_of(const SpoolFolder::Name& name) {
  char text[64];
  std::snprintf(text, sizeof text, "%016" PRIx64 "-%016" PRIx64 "-%08" PRIx32 "%s", name.order,
                name.id.boot, name.id.sequence, SpoolFolder::kSuffix);
  return text;
}

/// nullopt when it is not such a name, to the letter.
std::optional<SpoolFolder::Name> name_of(const std::string& text) {
  SpoolFolder::Name name;
  const int read = std::sscanf(text.c_str(), "%16" SCNx64 "-%16" SCNx64 "-%8" SCNx32, &name.order,
                               &name.id.boot, &name.id.sequence);
  if (read != 3 || text != text_of(name)) return std::nullopt;
  return name;
}

Status write_all(int fd, const std::vector<std::uint8_t>& bytes, const fs::path& path) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t wrote = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote < 0) return io_error("cannot write", path, errno);
    done += static_cast<std::size_t>(wrote);
  }
  if (::fsync(fd) != 0) return io_error("cannot make durable", path, errno);
  return {};
}

}  // namespace

SpoolFolder::SpoolFolder(fs::path folder, int folder_fd, int lock_fd)
    : folder_(std::move(folder)), folder_fd_(folder_fd), lock_fd_(lock_fd) {}

SpoolFolder::~SpoolFolder() {
  ::close(lock_fd_);
  ::close(folder_fd_);
}

Result<std::unique_ptr<SpoolFolder>> SpoolFolder::open(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  const int folder_fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_fd < 0) return io_error("cannot use the folder", folder, errno);
  const int lock_fd = ::openat(folder_fd, kLock, O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  const bool locked = lock_fd >= 0 && ::flock(lock_fd, LOCK_EX | LOCK_NB) == 0;
  const int number = errno;
  std::unique_ptr<SpoolFolder> made(new SpoolFolder(folder, folder_fd, lock_fd));
  if (locked) return made;
  if (lock_fd < 0) return io_error("cannot write to the folder", folder, number);
  return Error{ErrorCode::conflict,
               "another agent uses the folder " + folder.string() + ": give each its own --spool"};
}

Result<std::vector<SpoolFolder::File>> SpoolFolder::list() {
  std::error_code error;
  fs::remove(folder_ / kHalfWritten, error);
  std::vector<File> files;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    const auto name = name_of(at->path().filename().string());
    std::error_code gone;
    const std::uint64_t bytes = name ? at->file_size(gone) : 0;
    if (name && !gone) files.push_back({*name, bytes});
  }
  if (error) return io_error("cannot read the folder", folder_, error.value());
  std::ranges::sort(files, {}, [](const File& file) { return file.name.order; });
  return files;
}

Status SpoolFolder::write(const Name& name, const std::vector<std::uint8_t>& bytes) {
  const fs::path beside = folder_ / kHalfWritten;
  const int fd = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) return io_error("cannot write", beside, errno);
  Status written = write_all(fd, bytes, beside);
  ::close(fd);
  if (written && ::rename(beside.c_str(), path_of(name).c_str()) != 0) {
    written = io_error("cannot write", path_of(name), errno);
  }
  if (written && ::fsync(folder_fd_) != 0) {
    written = io_error("cannot make durable", folder_, errno);
  }
  if (!written) ::unlink(beside.c_str());
  return written;
}

Result<std::vector<std::uint8_t>> SpoolFolder::read(const Name& name) const {
  const fs::path path = path_of(name);
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return io_error("cannot read", path, error.value());
  if (size > kMaxFileBytes) return Error{ErrorCode::corrupt, "it is too large; delete it"};
  std::ifstream in(path, std::ios::binary);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) return io_error("cannot read", path, EIO);
  return bytes;
}

Status SpoolFolder::remove(const Name& name) {
  const fs::path path = path_of(name);
  // Not made durable: what comes back is delivered once more, which changes nothing.
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) return io_error("cannot delete", path, errno);
  return {};
}

Status SpoolFolder::set_aside(const Name& name) {
  std::error_code error;
  fs::create_directories(folder_ / kAside, error);
  fs::rename(path_of(name), folder_ / kAside / text_of(name), error);
  if (error) return io_error("cannot set aside", path_of(name), error.value());
  return {};
}

fs::path SpoolFolder::path_of(const Name& name) const { return folder_ / text_of(name); }

}  // namespace cairn::agent
