#include "client/map_files/esri_ascii.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <map>

#include "client/map_files/words.h"

namespace cairn::map_files {

namespace {

using Head = std::map<std::string, double>;

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  return lower;
}

bool is_key(const std::string& word) {
  static constexpr const char* kKeys[] = {"ncols",     "nrows",     "xllcorner", "yllcorner",
                                          "xllcenter", "yllcenter", "cellsize",  "nodata_value"};
  return std::ranges::find(kKeys, word) != std::end(kKeys);
}

Error out_of_place(const Words& words, const Error& error) {
  return {error.code, words.bad(error.message).message};
}

/// Reads keys with their values; `first` becomes the word that follows them: the first height.
Result<Head> read_head(Words& words, std::string& first) {
  Head head;
  for (;;) {
    auto word = words.next();
    if (!word) return word.error();
    if (!*word) return words.bad("the file ends in its head");
    const std::string key = lower_case(**word);
    if (!is_key(key)) {
      first = key;
      return head;
    }
    auto text = words.next();
    if (!text) return text.error();
    const auto value = *text ? number_in(**text) : std::nullopt;
    if (!value) return words.bad(key + " is followed by no number");
    head[key] = *value;
  }
}

/// The corner's coordinate from xllcorner or xllcenter.
std::optional<double> corner_of(const Head& head, const std::string& axis, double cell_m) {
  if (const auto corner = head.find(axis + "llcorner"); corner != head.end()) return corner->second;
  if (const auto centre = head.find(axis + "llcenter"); centre != head.end()) {
    return centre->second - 0.5 * cell_m;
  }
  return {};
}

Result<RasterFrame> frame_of(const Head& head, const Words& words) {
  for (const char* key : {"ncols", "nrows", "cellsize"}) {
    if (!head.contains(key)) return words.bad(std::string("is no Esri ASCII grid: no ") + key);
  }
  const double cell_m = head.at("cellsize");
  const auto x_m = corner_of(head, "x", cell_m);
  const auto y_m = corner_of(head, "y", cell_m);
  if (!x_m || !y_m) return words.bad("no xllcorner and yllcorner (or xllcenter and yllcenter)");
  for (const double value : {head.at("ncols"), head.at("nrows"), cell_m, *x_m, *y_m}) {
    if (!(std::abs(value) < 1e9)) return words.bad("a value of the head is out of range");
  }
  if (!(cell_m > 0.0)) return words.bad("cellsize must be above 0");
  if (std::floor(head.at("ncols")) != head.at("ncols") ||
      std::floor(head.at("nrows")) != head.at("nrows")) {
    return words.bad("ncols and nrows must be whole");
  }
  RasterFrame frame;
  const auto columns = static_cast<std::int64_t>(head.at("ncols"));
  const auto rows = static_cast<std::int64_t>(head.at("nrows"));
  if (auto sized = set_size(frame, columns, rows); !sized) {
    return out_of_place(words, sized.error());
  }
  frame.cell_m = cell_m;
  frame.south_west = {*x_m, *y_m};
  return frame;
}

Result<std::int32_t> height_in(const Words& words, std::string_view word, double no_data_m) {
  if (word.empty()) return HeightRaster::kUnknown;
  const auto value = number_in(word);
  if (!value) {
    return words.bad("\"" + std::string(word.substr(0, 20)) + "\" is no height in metres");
  }
  auto height = height_mm_of(*value, no_data_m);
  if (!height) return out_of_place(words, height.error());
  return height;
}

/// "1.25", never "-0".
std::string metres_text(std::int32_t mm) {
  char text[32];
  const char* sign = mm < 0 ? "-" : "";
  const std::int64_t positive = std::abs(std::int64_t{mm});
  std::snprintf(text, sizeof text, "%s%lld.%03lld", sign, static_cast<long long>(positive / 1000),
                static_cast<long long>(positive % 1000));
  return text;
}

void write_rows(std::ofstream& file, const HeightRaster& raster, char separator,
                const char* unknown) {
  const RasterFrame& frame = raster.frame;
  std::string line;
  for (int row = frame.rows - 1; row >= 0; --row) {
    line.clear();
    for (int column = 0; column < frame.columns; ++column) {
      const std::int32_t height_mm = raster.height_mm[frame.at(column, row)];
      if (column > 0) line += separator;
      line += height_mm == HeightRaster::kUnknown ? std::string(unknown) : metres_text(height_mm);
    }
    file << line << '\n';
  }
}

}  // namespace

Result<HeightRaster> read_esri_ascii(const std::string& path) {
  auto words = Words::open(path);
  if (!words) return words.error();
  std::string word;
  auto head = read_head(*words, word);
  if (!head) return head.error();
  auto frame = frame_of(*head, *words);
  if (!frame) return frame.error();
  const double no_data_m =
      head->contains("nodata_value") ? head->at("nodata_value") : kUsualNoDataM;
  HeightRaster raster{*frame, std::vector<std::int32_t>(frame->cells())};
  for (int row = frame->rows - 1; row >= 0; --row) {
    for (int column = 0; column < frame->columns; ++column) {
      const auto height = height_in(*words, word, no_data_m);
      if (!height) return height.error();
      raster.height_mm[frame->at(column, row)] = *height;
      auto next = words->next();
      if (!next) return next.error();
      const bool last = row == 0 && column + 1 == frame->columns;
      if (next->has_value() == last) {
        return words->bad(last ? "more heights than ncols and nrows tell"
                               : "the file ends before its last height");
      }
      if (!last) word = **next;
    }
  }
  return raster;
}

Status write_esri_ascii(const std::string& path, const HeightRaster& raster) {
  auto file = create_file(path);
  if (!file) return file.error();
  const RasterFrame& frame = raster.frame;
  char head[256];
  std::snprintf(head, sizeof head,
                "ncols %d\nnrows %d\nxllcorner %.3f\nyllcorner %.3f\ncellsize %.3f\n"
                "NODATA_value %.0f\n",
                frame.columns, frame.rows, frame.south_west->x_m, frame.south_west->y_m,
                frame.cell_m, kUsualNoDataM);
  *file << head;
  write_rows(*file, raster, ' ', "-9999");
  return finish_file(*file, path);
}

Result<HeightRaster> read_csv_heights(const std::string& path) {
  auto words = Words::open(path);
  if (!words) return words.error();
  std::vector<std::int32_t> from_north;
  std::size_t columns = 0;
  std::int64_t line = 0;
  const auto ragged = [&] { return columns != 0 && from_north.size() % columns != 0; };
  for (;;) {
    auto word = words->next();
    if (!word) return word.error();
    const bool new_row = !*word || words->line() != line;
    if (new_row && line != 0) {
      if (columns == 0) columns = from_north.size();
      if (ragged()) return words->bad("the row before has not as many heights as the first");
    }
    if (!*word) break;
    line = words->line();
    const auto height = height_in(*words, **word, kUsualNoDataM);
    if (!height) return height.error();
    if (from_north.size() == static_cast<std::size_t>(RasterFrame::kMaxCells)) {
      return Error{ErrorCode::exhausted, path + ": more heights than are read at once (" +
                                             std::to_string(RasterFrame::kMaxCells) + ")"};
    }
    from_north.push_back(*height);
  }
  if (columns == 0) return Error{ErrorCode::corrupt, path + ": has no heights"};
  HeightRaster raster;
  const auto rows = from_north.size() / columns;
  if (auto sized = set_size(raster.frame, static_cast<std::int64_t>(columns),
                            static_cast<std::int64_t>(rows));
      !sized) {
    return sized.error();
  }
  for (std::size_t low = 0, high = rows - 1; low < high; ++low, --high) {
    const auto row = [&](std::size_t index) {
      return from_north.begin() + static_cast<std::ptrdiff_t>(index * columns);
    };
    std::swap_ranges(row(low), row(low + 1), row(high));
  }
  raster.height_mm = std::move(from_north);
  return raster;
}

Status write_csv_heights(const std::string& path, const HeightRaster& raster) {
  auto file = create_file(path);
  if (!file) return file.error();
  write_rows(*file, raster, ',', "nan");
  return finish_file(*file, path);
}

}  // namespace cairn::map_files
