#include "client/map_files/words.h"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <utility>

namespace cairn::map_files {

namespace {

bool is_blank(int c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_comma(int c) { return c == ',' || c == ';'; }
/// UTF-8 is let through, control characters are not.
bool is_text(int c) { return c >= ' ' && c != 127; }

constexpr int kEnd = std::char_traits<char>::eof();

template <class T>
std::optional<T> parsed(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = fault == std::errc() && end == text.data() + text.size() && !text.empty();
  return whole ? std::optional(value) : std::nullopt;
}

}  // namespace

Result<Words> Words::open(const std::string& path) {
  if (auto readable = check_readable(path); !readable) return readable.error();
  return Words(path, std::ifstream(path, std::ios::binary));
}

int Words::take() {
  const int c = file_.rdbuf()->sbumpc();
  if (c == '\n') ++line_;
  return c;
}

Result<std::optional<std::string_view>> Words::next() {
  word_.clear();
  word_line_ = line_;
  for (int c = take();; word_line_ = line_, c = take()) {
    if (c == kEnd) return std::optional<std::string_view>();
    if (is_blank(c)) continue;
    if (c == '\n') {
      field_open_ = true;
    } else if (is_comma(c)) {
      if (std::exchange(field_open_, true)) return std::optional<std::string_view>("");
    } else {
      if (!is_text(c)) return bad("is no text file");
      word_.push_back(static_cast<char>(c));
      break;
    }
  }
  field_open_ = false;
  for (int c = file_.rdbuf()->sgetc(); c != kEnd; c = file_.rdbuf()->sgetc()) {
    if (is_blank(c) || c == '\n' || is_comma(c)) break;
    if (!is_text(c)) return bad("is no text file");
    if (word_.size() == kMaxWordBytes) return bad("a word is too long for a number or a name");
    word_.push_back(static_cast<char>(take()));
  }
  return std::optional<std::string_view>(word_);
}

Result<std::string> Words::rest_of_line() {
  std::string rest;
  word_line_ = line_;
  for (int c = take(); c != kEnd && c != '\n'; c = take()) {
    if (c == '\r') continue;
    if (rest.size() == kMaxLineBytes) return bad("the line is too long");
    rest.push_back(static_cast<char>(c));
  }
  field_open_ = true;
  return rest;
}

Error Words::bad(const std::string& what) const {
  return {ErrorCode::corrupt, path_ + ", line " + std::to_string(word_line_) + ": " + what};
}

std::optional<double> number_in(std::string_view text) { return parsed<double>(text); }
std::optional<std::int64_t> whole_number_in(std::string_view text) {
  return parsed<std::int64_t>(text);
}

Status check_readable(const std::string& path) {
  std::error_code fault;
  const auto status = std::filesystem::status(path, fault);
  if (!std::filesystem::exists(status)) {
    return Error{ErrorCode::not_found, "there is no file " + path};
  }
  if (!std::filesystem::is_regular_file(status)) {
    return Error{ErrorCode::io, path + " is no file"};
  }
  if (!std::ifstream(path)) {
    return Error{ErrorCode::io, "cannot read " + path + ": " + std::strerror(errno)};
  }
  return {};
}

Result<std::ofstream> create_file(const std::string& path) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) {
    return Error{ErrorCode::io, "cannot write " + path + ": " + std::strerror(errno)};
  }
  return file;
}

Status finish_file(std::ofstream& file, const std::string& path) {
  file.close();
  if (file.fail()) {
    return Error{ErrorCode::io, "cannot write " + path + " to its end: is the disk full?"};
  }
  return {};
}

}  // namespace cairn::map_files
