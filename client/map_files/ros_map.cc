#include "client/map_files/ros_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "client/map_files/grey_picture.h"
#include "client/map_files/words.h"

namespace cairn::map_files {

namespace {

constexpr std::uint8_t kFreeGrey = 254;
constexpr std::uint8_t kOccupiedGrey = 0;
constexpr std::uint8_t kUnknownGrey = 205;
/// [lines] A description has about seven.
constexpr int kMaxLines = 1000;

std::string trimmed(std::string_view text, std::string_view what = " \t\r") {
  const auto first = text.find_first_not_of(what);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(what) - first + 1));
}

std::string without_comment(const std::string& line) {
  for (std::size_t at = line.find('#'); at != std::string::npos; at = line.find('#', at + 1)) {
    if (at == 0 || line[at - 1] == ' ' || line[at - 1] == '\t') return line.substr(0, at);
  }
  return line;
}

/// The part of YAML that maps are described in: `key: value`, values being words, quoted words and
/// lists of them, `[a, b]` or `- a` on lines of their own.
using Description = std::map<std::string, std::vector<std::string>>;

std::vector<std::string> items_of(const std::string& value) {
  std::vector<std::string> items;
  const bool list = value.starts_with('[') && value.ends_with(']');
  const std::string inside = list ? value.substr(1, value.size() - 2) : value;
  for (std::size_t at = 0; at <= inside.size();) {
    const std::size_t end = list ? std::min(inside.find(',', at), inside.size()) : inside.size();
    const std::string item = trimmed(trimmed(inside.substr(at, end - at)), "\"'");
    if (!item.empty()) items.push_back(item);
    at = end + 1;
  }
  return items;
}

Result<Description> read_description(const std::string& path) {
  auto words = Words::open(path);
  if (!words) return words.error();
  Description description;
  std::string key;
  for (int count = 0; count < kMaxLines; ++count) {
    auto rest = words->rest_of_line();
    if (!rest) return rest.error();
    const std::string line = trimmed(without_comment(*rest));
    if (line.starts_with("- ") && !key.empty()) {
      for (const std::string& item : items_of(line.substr(2))) description[key].push_back(item);
      continue;
    }
    const auto colon = line.find(':');
    if (colon == std::string::npos) continue;
    key = trimmed(line.substr(0, colon));
    description[key] = items_of(trimmed(line.substr(colon + 1)));
  }
  return description;
}

/// A map's description with every value checked.
struct RosMap {
  std::string image;
  std::string mode = "trinary";
  double resolution_m = 0.0;
  std::array<double, 3> origin{};
  double occupied = 0.0;
  double free = 0.0;
  bool negate = false;
};

class Reader {
 public:
  Reader(std::string path, Description description)
      : path_(std::move(path)), description_(std::move(description)) {}

  Result<RosMap> read() {
    RosMap map;
    map.image = word("image");
    map.resolution_m = number("resolution");
    for (int i = 0; i < 3; ++i) map.origin[static_cast<std::size_t>(i)] = number("origin", i, 3);
    map.occupied = number("occupied_thresh");
    map.free = number("free_thresh");
    const std::string negate = word("negate");
    map.negate = negate == "1" || negate == "true";
    if (!map.negate && negate != "0" && negate != "false") blame("negate must be 0 or 1");
    if (description_.contains("mode")) map.mode = word("mode");
    judge(map);
    if (!fault_.empty()) return Error{ErrorCode::corrupt, path_ + ": " + fault_};
    return map;
  }

 private:
  void blame(const std::string& what) {
    if (fault_.empty()) fault_ = what;
  }

  std::string word(const std::string& key, int i = 0, int of = 1) {
    const auto found = description_.find(key);
    if (found == description_.end()) {
      blame("is no map of map_server: the key " + key + " is missing");
      return {};
    }
    if (found->second.size() != static_cast<std::size_t>(of)) {
      blame(key + " must have " + std::to_string(of) + (of == 1 ? " value" : " values"));
      return {};
    }
    return found->second[static_cast<std::size_t>(i)];
  }

  double number(const std::string& key, int i = 0, int of = 1) {
    const std::string text = word(key, i, of);
    const auto value = number_in(text);
    if (!value || !(std::abs(*value) < 1e9)) {
      blame(key + ": \"" + text + "\" is no usable number");
      return 0.0;
    }
    return *value;
  }

  void judge(const RosMap& map) {
    if (!(map.resolution_m > 0.0)) blame("resolution must be above 0");
    const bool ordered = 0.0 <= map.free && map.free <= map.occupied && map.occupied <= 1.0;
    if (!ordered) blame("free_thresh must not be above occupied_thresh, both from 0 to 1");
    if (map.mode != "trinary" && map.mode != "scale" && map.mode != "raw") {
      blame("mode must be trinary, scale or raw");
    }
    if (std::abs(map.origin[2]) > 7.0) blame("the origin's yaw must be radians");
  }

  std::string path_;
  Description description_;
  std::string fault_;
};

CellClass class_of(std::uint8_t grey, const RosMap& map) {
  double occupancy = map.negate ? grey / 255.0 : (255 - grey) / 255.0;
  if (map.mode == "raw") {
    if (grey > 100) return CellClass::unknown;
    occupancy = grey / 100.0;
  }
  if (occupancy > map.occupied) return CellClass::obstacle;
  return occupancy < map.free ? CellClass::free : CellClass::unknown;
}

std::uint8_t grey_of(CellClass cell) {
  if (cell == CellClass::unknown) return kUnknownGrey;
  return cell == CellClass::free ? kFreeGrey : kOccupiedGrey;
}

}  // namespace

Result<ClassRaster> read_ros_map(const std::string& yaml_path) {
  auto description = read_description(yaml_path);
  if (!description) return description.error();
  auto map = Reader(yaml_path, *std::move(description)).read();
  if (!map) return map.error();
  const auto image = std::filesystem::path(yaml_path).parent_path() / map->image;
  auto picture = read_grey_picture(image.string());
  if (!picture) return picture.error();

  ClassRaster raster;
  if (auto sized = set_size(raster.frame, picture->columns, picture->rows); !sized) {
    return sized.error();
  }
  raster.frame.cell_m = map->resolution_m;
  raster.frame.south_west = {map->origin[0], map->origin[1]};
  raster.frame.yaw_rad = map->origin[2];
  std::array<CellClass, 256> classes{};
  for (std::size_t grey = 0; grey < classes.size(); ++grey) {
    classes[grey] = class_of(static_cast<std::uint8_t>(grey), *map);
  }
  raster.classes.reserve(picture->grey.size());
  for (int row = 0; row < picture->rows; ++row) {
    const std::size_t start = raster.frame.at(0, picture->rows - 1 - row);
    for (int column = 0; column < picture->columns; ++column) {
      raster.classes.push_back(classes[picture->grey[start + static_cast<std::size_t>(column)]]);
    }
  }
  return raster;
}

Status write_ros_map(const std::string& path, const ClassRaster& raster) {
  const RasterFrame& frame = raster.frame;
  const auto pgm = std::filesystem::path(path).replace_extension(".pgm");
  const auto yaml = std::filesystem::path(path).replace_extension(".yaml");
  GreyPicture picture{frame.columns, frame.rows, {}};
  picture.grey.reserve(frame.cells());
  for (int row = frame.rows - 1; row >= 0; --row) {
    for (int column = 0; column < frame.columns; ++column) {
      picture.grey.push_back(grey_of(raster.classes[frame.at(column, row)]));
    }
  }
  if (auto written = write_pgm(pgm.string(), picture); !written) return written;
  auto file = create_file(yaml.string());
  if (!file) return file.error();
  char origin[128];
  std::snprintf(origin, sizeof origin, "resolution: %.3f\norigin: [%.3f, %.3f, 0.0]\n",
                frame.cell_m, frame.south_west->x_m, frame.south_west->y_m);
  *file << "image: " << pgm.filename().string() << '\n'
        << "mode: trinary\n"
        << origin << "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  return finish_file(*file, yaml.string());
}

}  // namespace cairn::map_files
