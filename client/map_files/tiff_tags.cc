#include "client/map_files/tiff_tags.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <map>

#include "client/map_files/words.h"

namespace cairn::map_files {

namespace {

// Tags of TIFF 6.0, GeoTIFF 1.1 and GDAL.
constexpr std::uint16_t kWidth = 256;
constexpr std::uint16_t kLength = 257;
constexpr std::uint16_t kPixelScale = 33550;
constexpr std::uint16_t kTiepoint = 33922;
constexpr std::uint16_t kGeoKeys = 34735;
constexpr std::uint16_t kNoData = 42113;
// GeoTIFF's keys and their values.
constexpr std::uint64_t kModelType = 1024;
constexpr std::uint64_t kRasterType = 1025;
constexpr std::uint64_t kGeographic = 2;
constexpr std::uint64_t kPixelIsPoint = 2;

/// [entries], [values] More are no picture of ours.
constexpr std::uint64_t kMaxEntries = 1000;
constexpr std::uint64_t kMaxValues = 4096;

struct Entry {
  std::uint16_t type = 0;
  std::uint64_t count = 0;
  std::uint64_t at = 0;  ///< Byte in the file where the values stand.
};

class TiffFile {
 public:
  explicit TiffFile(const std::string& path) : file_(path, std::ios::binary) {}

  bool read_directory() {
    const std::uint64_t order = integer(0, 2);
    big_endian_ = order == 0x4D4D;
    if ((order != 0x4949 && !big_endian_) || integer(2, 2) != 42) return false;
    const std::uint64_t start = integer(4, 4);
    const std::uint64_t entries = integer(start, 2);
    if (!file_ || entries == 0 || entries > kMaxEntries) return false;
    for (std::uint64_t i = 0; i < entries; ++i) read_entry(start + 2 + 12 * i);
    return static_cast<bool>(file_);
  }

  /// Values of a tag as numbers; empty when it is not there.
  std::vector<double> numbers(std::uint16_t tag) {
    std::vector<double> values;
    const auto found = entries_.find(tag);
    if (found == entries_.end()) return values;
    const Entry& entry = found->second;
    const int size = size_of(entry.type);
    for (std::uint64_t i = 0; i < std::min(entry.count, kMaxValues); ++i) {
      const std::uint64_t bits = integer(entry.at + i * static_cast<std::uint64_t>(size), size);
      values.push_back(entry.type == 12 ? std::bit_cast<double>(bits) : static_cast<double>(bits));
    }
    return file_ ? values : std::vector<double>{};
  }

  std::string text(std::uint16_t tag) {
    std::string text;
    for (const double value : numbers(tag)) {
      if (value == 0.0) break;
      text.push_back(static_cast<char>(value));
    }
    return text;
  }

 private:
  static int size_of(std::uint16_t type) {
    if (type == 3) return 2;   // SHORT
    if (type == 4) return 4;   // LONG
    if (type == 12) return 8;  // DOUBLE
    return 1;                  // BYTE, ASCII and what we do not read.
  }

  void read_entry(std::uint64_t at) {
    Entry entry;
    const auto tag = static_cast<std::uint16_t>(integer(at, 2));
    entry.type = static_cast<std::uint16_t>(integer(at + 2, 2));
    entry.count = integer(at + 4, 4);
    const bool inline_value = entry.count * static_cast<std::uint64_t>(size_of(entry.type)) <= 4;
    entry.at = inline_value ? at + 8 : integer(at + 8, 4);
    entries_.emplace(tag, entry);
  }

  std::uint64_t integer(std::uint64_t at, int bytes) {
    unsigned char raw[8] = {};
    file_.seekg(static_cast<std::streamoff>(at));
    file_.read(reinterpret_cast<char*>(raw), bytes);
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) {
      value = value << 8U | raw[big_endian_ ? i : bytes - 1 - i];
    }
    return value;
  }

  std::ifstream file_;
  bool big_endian_ = false;
  std::map<std::uint16_t, Entry> entries_;
};

/// A GeoTIFF key's value; 0 when it is not there.
std::uint64_t geo_key(const std::vector<double>& directory, std::uint64_t key) {
  for (std::size_t i = 4; i + 3 < directory.size(); i += 4) {
    const bool here = static_cast<std::uint64_t>(directory[i]) == key && directory[i + 1] == 0.0;
    if (here) return static_cast<std::uint64_t>(directory[i + 3]);
  }
  return 0;
}

Status place(TiffFile& file, RasterFrame& frame) {
  const std::vector<double> scale = file.numbers(kPixelScale);
  if (scale.size() < 2) return {};
  const std::vector<double> keys = file.numbers(kGeoKeys);
  if (geo_key(keys, kModelType) == kGeographic) {
    return Error{ErrorCode::invalid_argument,
                 "its coordinates are degrees: project it to metres first"};
  }
  if (!(scale[0] > 0.0) || std::abs(scale[0] - scale[1]) > 1e-6 * scale[0]) {
    return Error{ErrorCode::invalid_argument, "its cells are not square"};
  }
  frame.cell_m = scale[0];
  const std::vector<double> tie = file.numbers(kTiepoint);
  if (tie.size() < 6) return {};
  const double half = geo_key(keys, kRasterType) == kPixelIsPoint ? 0.5 : 0.0;
  const double west_m = tie[3] - (tie[0] + half) * scale[0];
  const double north_m = tie[4] + (tie[1] + half) * scale[1];
  if (!std::isfinite(west_m) || !std::isfinite(north_m)) return {};
  frame.south_west = {west_m, north_m - frame.rows * scale[1]};
  return {};
}

}  // namespace

Result<TiffTags> read_tiff_tags(const std::string& path) {
  if (auto readable = check_readable(path); !readable) return readable.error();
  TiffFile file(path);
  if (!file.read_directory()) {
    return Error{ErrorCode::corrupt, path + ": is no TIFF, or cut short"};
  }
  const std::vector<double> width = file.numbers(kWidth);
  const std::vector<double> length = file.numbers(kLength);
  if (width.empty() || length.empty()) {
    return Error{ErrorCode::corrupt, path + ": the TIFF does not tell its size"};
  }
  TiffTags tags;
  Status sound = set_size(tags.frame, static_cast<std::int64_t>(width[0]),
                          static_cast<std::int64_t>(length[0]));
  if (sound) sound = place(file, tags.frame);
  if (!sound) return Error{sound.error().code, path + ": " + sound.error().message};
  if (const auto no_data = number_in(file.text(kNoData))) tags.no_data_m = *no_data;
  return tags;
}

}  // namespace cairn::map_files
