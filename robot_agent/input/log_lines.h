#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <memory>
#include <optional>
#include <string>

#include "core/common/result.h"

namespace cairn::agent {

/// The lines of a text file, plain or packed with gzip or bzip2 (told by the file's first bytes),
/// one at a time: memory does not grow with the file.
class LogLines {
 public:
  static constexpr std::size_t kMaxLineBytes = 256U << 10U;
  static constexpr std::uint64_t kMaxUnpackedBytes = std::uint64_t{4} << 30U;

  /// Errors: no such file, or it cannot be read.
  [[nodiscard]] static Result<LogLines> open(const std::string& path);

  /// The next line without its end; nothing at the end of the file.
  /// Errors: a line or a file beyond the bounds above; a packed stream that is damaged or cut off.
  [[nodiscard]] Result<std::optional<std::string>> next();

  /// Of the line last returned, counted from 1.
  [[nodiscard]] std::uint64_t number() const { return number_; }
  /// Whether that line lacked its end, as the last line of a file that was cut off does.
  [[nodiscard]] bool unfinished() const { return unfinished_; }

 private:
  LogLines(std::string path, std::unique_ptr<std::istream> stream);
  [[nodiscard]] Error bad(const std::string& what) const;
  [[nodiscard]] std::optional<std::string> read_line();

  std::string path_;
  std::unique_ptr<std::istream> stream_;
  std::uint64_t number_ = 0;
  std::uint64_t unpacked_bytes_ = 0;
  bool unfinished_ = false;
};

}  // namespace cairn::agent
