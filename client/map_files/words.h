#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "core/common/result.h"

namespace cairn::map_files {

/// Reads a text file word by word in bounded memory. Words stand between blanks, line ends, commas
/// and semicolons; nothing between two commas is an empty word.
class Words {
 public:
  /// not_found, or io when it is no readable file.
  static Result<Words> open(const std::string& path);

  /// The next word, valid until the next call; nothing at the end of the file. corrupt for a word
  /// longer than kMaxWordBytes or with a byte that is no text.
  Result<std::optional<std::string_view>> next();
  /// The rest of the line where the last word ended, without its end.
  Result<std::string> rest_of_line();
  [[nodiscard]] bool at_end() { return file_.peek() == std::char_traits<char>::eof(); }
  [[nodiscard]] std::int64_t line() const { return word_line_; }  ///< Of the last word, from 1.
  [[nodiscard]] const std::string& path() const { return path_; }
  /// corrupt: "PATH, line N: what".
  [[nodiscard]] Error bad(const std::string& what) const;

  static constexpr std::size_t kMaxWordBytes = 128;
  static constexpr std::size_t kMaxLineBytes = 1 << 20;

 private:
  Words(std::string path, std::ifstream file) : path_(std::move(path)), file_(std::move(file)) {}
  int take();

  std::string path_;
  std::ifstream file_;
  std::string word_;
  std::int64_t line_ = 1;
  std::int64_t word_line_ = 1;
  bool field_open_ = true;  ///< A comma now would end an empty field.
};

/// The number that is all of `text`; nothing when it is not one. NaN and infinities are numbers.
[[nodiscard]] std::optional<double> number_in(std::string_view text);
[[nodiscard]] std::optional<std::int64_t> whole_number_in(std::string_view text);

/// not_found when there is no such file, io when it is a folder or cannot be read.
[[nodiscard]] Status check_readable(const std::string& path);
/// Opened for writing, or io.
[[nodiscard]] Result<std::ofstream> create_file(const std::string& path);
/// io when what was written did not all reach the file.
[[nodiscard]] Status finish_file(std::ofstream& file, const std::string& path);

}  // namespace cairn::map_files
