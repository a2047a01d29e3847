#include "robot_agent/input/log_lines.h"

#include <boost/iostreams/filter/bzip2.hpp>
#include <boost/iostreams/filter/gzip.hpp>
#include <boost/iostreams/filtering_stream.hpp>
#include <filesystem>
#include <fstream>
#include <utility>

namespace cairn::agent {
namespace {

enum class Packing { none, gzip, bzip2 };

Packing packing_of(std::istream& file) {
  std::string magic(3, '\0');
  file.read(magic.data(), 3);
  file.clear();
  file.seekg(0);
  if (magic.starts_with("\x1F\x8B")) {
    return Packing::gzip;
  }
  return magic == "BZh" ? Packing::bzip2 : Packing::none;
}

// Hides boost's stream, which must own the file below it.
class UnpackingStream : public boost::iostreams::filtering_istream {
 public:
  UnpackingStream(std::ifstream file, Packing packing) : file_(std::move(file)) {
    if (packing == Packing::gzip) {
      push(boost::iostreams::gzip_decompressor());
    } else if (packing == Packing::bzip2) {
      push(boost::iostreams::bzip2_decompressor());
    }
    push(file_);
    exceptions(std::ios::badbit);  // So that a damaged stream is told from a finished one.
  }
  ~UnpackingStream() override { reset(); }
  UnpackingStream(const UnpackingStream&) = delete;
  UnpackingStream& operator=(const UnpackingStream&) = delete;

 private:
  std::ifstream file_;
};

}  // namespace

Result<LogLines> LogLines::open(const std::string& path) {
  std::error_code fault;
  if (!std::filesystem::is_regular_file(path, fault)) {
    return Error{ErrorCode::not_found, "there is no log file " + path};
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return Error{ErrorCode::io, "log file " + path + " cannot be opened; may it be read?"};
  }
  const Packing packing = packing_of(file);
  return LogLines(path, std::make_unique<UnpackingStream>(std::move(file), packing));
}

LogLines::LogLines(std::string path, std::unique_ptr<std::istream> stream)
    : path_(std::move(path)), stream_(std::move(stream)) {}

Error LogLines::bad(const std::string& what) const {
  return {ErrorCode::corrupt, path_ + ", line " + std::to_string(number_) + ": " + what};
}

Result<std::optional<std::string>> LogLines::next() {
  ++number_;
  std::optional<std::string> line;
  try {
    line = read_line();
  } catch (const std::exception&) {
    return bad("the packed file is damaged or cut off here; unpack what is left of it");
  }
  if (line && line->size() > kMaxLineBytes) {
    return bad("longer than 256 kB; this is no CARMEN log");
  }
  if (unpacked_bytes_ > kMaxUnpackedBytes) {
    return bad("more than 4 GiB unpacked; cut the log into parts");
  }
  return line;
}

std::optional<std::string> LogLines::read_line() {
  std::string line;
  std::streambuf& bytes = *stream_->rdbuf();
  while (line.size() <= kMaxLineBytes) {
    const int byte = bytes.sbumpc();
    if (byte == std::char_traits<char>::eof()) {
      unfinished_ = !line.empty();
      return line.empty() ? std::nullopt : std::optional(std::move(line));
    }
    ++unpacked_bytes_;
    if (byte == '\n') {
      break;
    }
    line.push_back(static_cast<char>(byte));
  }
  return line;
}

}  // namespace cairn::agent
