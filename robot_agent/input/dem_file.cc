#include "robot_agent/input/dem_file.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <regex>
#include <vector>

namespace cairn::agent {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 30U;
constexpr double kLeastCellM = 0.005;
constexpr double kLargestCellM = 100.0;

// As in the file: the first row is the northernmost.
struct Grid {
  int columns = 0;
  int rows = 0;
  std::vector<float> heights_m;
};

float usable(float height_m) {
  // ±100 km is beyond any place on earth and marks a wrong file as missing.
  const bool real = std::isfinite(height_m) && height_m > -9000.0F && height_m < 1e5F;
  return real ? height_m : kMissing;
}

Error bad(const std::string& path, const std::string& what) {
  return {ErrorCode::corrupt, "terrain file " + path + ": " + what};
}

std::optional<double> number(std::string_view text) {
  double value = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = fault == std::errc() && end == text.data() + text.size();
  return whole ? std::optional(value) : std::nullopt;
}

Result<double> cell_size(const std::string& path, const std::optional<std::string>& option) {
  if (option) {
    const auto size = number(*option);
    if (size && *size >= kLeastCellM && *size <= kLargestCellM) {
      return *size;
    }
    return Error{ErrorCode::invalid_argument,
                 "cell size \"" + *option +
                     "\" must be metres from 0.005 to 100, as in dem:" + path + "@0.25"};
  }
  static const std::regex part("(?:^|[^0-9.])([0-9]+(?:\\.[0-9]+)?)(cm|m)(?![a-z])");
  const std::string stem = std::filesystem::path(path).stem().string();
  // "10cmDEM" ends its unit with a capital.
  std::smatch match;
  if (std::regex_search(stem, match, part)) {
    const double size = std::stod(match[1]) * (match[2] == "cm" ? 0.01 : 1.0);
    if (size >= kLeastCellM && size <= kLargestCellM) {
      return size;
    }
  }
  return Error{ErrorCode::invalid_argument,
               "the cell size of " + path +
                   " is unknown; add it in metres at the end, as in dem:" + path + "@0.25"};
}

Status read_row(std::string_view line, const std::string& where, Grid& grid) {
  int columns = 0;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t begin = line.find_first_not_of(" \t,;\r", at);
    if (begin == std::string_view::npos) {
      break;
    }
    const std::size_t end = std::min(line.find_first_of(" \t,;\r", begin), line.size());
    const std::string_view word = line.substr(begin, end - begin);
    const auto height = number(word);
    if (!height) {
      return bad(where, "\"" + std::string(word.substr(0, 20)) + "\" is not a height in metres");
    }
    if (grid.heights_m.size() == HeightRaster::kMaxNodes) {
      return bad(where, "more than 64 M heights; cut the file or make its cells larger");
    }
    grid.heights_m.push_back(usable(static_cast<float>(*height)));
    ++columns;
    at = end;
  }
  if (columns == 0) {
    return {};
  }
  if (grid.rows > 0 && columns != grid.columns) {
    return bad(where, std::to_string(columns) + " heights where the rows before have " +
                          std::to_string(grid.columns));
  }
  grid.columns = columns;
  ++grid.rows;
  return {};
}

Result<Grid> read_csv(const std::string& path) {
  std::ifstream file(path);
  Grid grid;
  std::string line;
  for (int number_of_line = 1; std::getline(file, line); ++number_of_line) {
    const auto row = read_row(line, path + ", line " + std::to_string(number_of_line), grid);
    if (!row) {
      return row.error();
    }
  }
  if (file.bad()) {
    return Error{ErrorCode::io, "terrain file " + path + " could not be read to its end"};
  }
  return grid;
}

Result<Grid> read_image(const std::string& path) {
  cv::Mat image;
  try {
    image = cv::imread(path, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    return bad(path, "the TIFF cannot be decoded; is it whole and below 2^30 pixels?");
  }
  if (image.empty()) {
    return bad(path, "not a readable TIFF; .tif, .tiff and .csv files are understood");
  }
  if (image.type() != CV_32FC1) {
    return bad(path, "must have one channel of 32-bit float heights in metres");
  }
  if (image.total() > HeightRaster::kMaxNodes) {
    return bad(path, "more than 64 M heights; cut the file or make its cells larger");
  }
  Grid grid{image.cols, image.rows, {}};
  grid.heights_m.reserve(image.total());
  for (int row = 0; row < image.rows; ++row) {
    const auto* heights = image.ptr<float>(row);
    for (int column = 0; column < image.cols; ++column) {
      grid.heights_m.push_back(usable(heights[column]));
    }
  }
  return grid;
}

class HoleFiller {
 public:
  explicit HoleFiller(Grid& grid) : grid_(grid) {}

  // Each ring of a hole takes the mean of what is known around it; every missing node is filled
  // once, so the work is bounded by the grid.
  void fill() {
    std::vector<std::size_t> ring = edge_of_holes();
    std::vector<bool> queued(grid_.heights_m.size(), false);
    while (!ring.empty()) {
      std::vector<float> means;
      means.reserve(ring.size());
      for (const std::size_t node : ring) {
        means.push_back(mean_around(node));
      }
      for (std::size_t i = 0; i < ring.size(); ++i) {
        grid_.heights_m[ring[i]] = means[i];
      }
      ring = missing_around(ring, queued);
    }
  }

 private:
  template <class Visit>
  void around(std::size_t node, Visit visit) const {
    const auto width = static_cast<std::size_t>(grid_.columns);
    const int column = static_cast<int>(node % width);
    const int row = static_cast<int>(node / width);
    for (int r = std::max(0, row - 1); r <= std::min(grid_.rows - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(grid_.columns - 1, column + 1); ++c) {
        visit(static_cast<std::size_t>(r) * width + static_cast<std::size_t>(c));
      }
    }
  }

  [[nodiscard]] float mean_around(std::size_t node) const {
    double sum = 0.0;
    int count = 0;
    around(node, [&](std::size_t other) {
      const float height = grid_.heights_m[other];
      sum += std::isnan(height) ? 0.0 : double{height};
      count += std::isnan(height) ? 0 : 1;
    });
    return count > 0 ? static_cast<float>(sum / count) : kMissing;
  }

  [[nodiscard]] std::vector<std::size_t> edge_of_holes() const {
    std::vector<std::size_t> edge;
    for (std::size_t node = 0; node < grid_.heights_m.size(); ++node) {
      if (std::isnan(grid_.heights_m[node]) && !std::isnan(mean_around(node))) {
        edge.push_back(node);
      }
    }
    return edge;
  }

  [[nodiscard]] std::vector<std::size_t> missing_around(const std::vector<std::size_t>& ring,
                                                        std::vector<bool>& queued) const {
    std::vector<std::size_t> next;
    for (const std::size_t node : ring) {
      around(node, [&](std::size_t other) {
        if (std::isnan(grid_.heights_m[other]) && !queued[other]) {
          queued[other] = true;
          next.push_back(other);
        }
      });
    }
    return next;
  }

  Grid& grid_;
};

HeightRaster to_raster(const Grid& grid, double cell_m) {
  HeightRaster raster(cell_m, grid.columns, grid.rows, -0.5 * cell_m * (grid.columns - 1),
                      -0.5 * cell_m * (grid.rows - 1));
  auto height = grid.heights_m.begin();
  for (int row = grid.rows - 1; row >= 0; --row) {
    for (int column = 0; column < grid.columns; ++column) {
      raster.at(column, row) = *height++;
    }
  }
  return raster;
}

Status check_file(const std::string& path) {
  std::error_code fault;
  if (!std::filesystem::is_regular_file(path, fault)) {
    return Error{ErrorCode::not_found, "there is no terrain file " + path};
  }
  const std::uintmax_t bytes = std::filesystem::file_size(path, fault);
  if (fault || bytes == 0) {
    return bad(path, "is empty or cannot be read");
  }
  if (bytes > kMaxFileBytes) {
    return bad(path, "is larger than 1 GiB; cut it");
  }
  return {};
}

Status check_grid(const std::string& path, const Grid& grid) {
  if (grid.columns < 2 || grid.rows < 2) {
    return bad(path, "has fewer than 2 rows or 2 columns of heights");
  }
  for (const float height : grid.heights_m) {
    if (!std::isnan(height)) {
      return {};
    }
  }
  return bad(path, "has no height at all, only no-data values");
}

}  // namespace

Result<HeightRaster> read_dem(const std::string& name) {
  const std::size_t at = name.rfind('@');
  const std::string path = name.substr(0, at);
  const auto option = at == std::string::npos ? std::nullopt : std::optional(name.substr(at + 1));
  if (const auto file = check_file(path); !file) {
    return file.error();
  }
  const auto cell = cell_size(path, option);
  if (!cell) {
    return cell.error();
  }
  auto grid = std::filesystem::path(path).extension() == ".csv" ? read_csv(path) : read_image(path);
  if (!grid) {
    return grid.error();
  }
  if (const auto sound = check_grid(path, *grid); !sound) {
    return sound.error();
  }
  HoleFiller(*grid).fill();
  return to_raster(*grid, *cell);
}

}  // namespace cairn::agent
