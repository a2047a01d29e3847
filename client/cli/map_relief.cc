#include "client/cli/map_relief.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cairn::cli {

namespace {

constexpr int kHatchPx = 9;

/// Anchors of the tint, from low to high.
constexpr std::array<std::array<float, 3>, 4> kTints = {{
    {176.0F, 208.0F, 190.0F},
    {196.0F, 226.0F, 234.0F},
    {150.0F, 188.0F, 216.0F},
    {146.0F, 164.0F, 186.0F},
}};

/// Height difference towards a neighbour; none where nothing is known or a wall begins, whose
/// shadow would hide the ground before it.
float rise(const MapRaster& raster, int column, int row, int dc, int dr) {
  if (!raster.known(column + dc, row + dr)) return 0.0F;
  const auto near = raster.at(column + dc, row + dr);
  if (raster.classes[near] == CellClass::obstacle) return 0.0F;
  return raster.height_m[near] - raster.height_m[raster.at(column, row)];
}

/// Brightness of a pixel: 1 on level ground.
float shade(const MapRaster& raster, int column, int row, float exaggeration) {
  const float east = rise(raster, column, row, 1, 0) - rise(raster, column, row, -1, 0);
  const float north = rise(raster, column, row, 0, -1) - rise(raster, column, row, 0, 1);
  const float slope_x = std::clamp(east * exaggeration, -1.5F, 1.5F);
  const float slope_y = std::clamp(north * exaggeration, -1.5F, 1.5F);
  // Light from the north-west, 45° above the horizon: (-½, ½, √½) · normal.
  const float lit = (0.5F * slope_x - 0.5F * slope_y + 0.7071F) /
                    std::sqrt(slope_x * slope_x + slope_y * slope_y + 1.0F);
  return 0.55F + 0.45F * std::max(lit, 0.0F) / 0.7071F;
}

/// How much to stretch heights: steep ground (95th percentile of the rises) shall look steep, and
/// the noise of a flat floor shall not.
float exaggeration_for(const MapRaster& raster) {
  std::vector<float> rises;
  for (int row = 0; row < raster.height; ++row) {
    for (int column = row % 3; column < raster.width; column += 3) {
      if (raster.classes[raster.at(column, row)] != CellClass::free) continue;
      rises.push_back(std::abs(rise(raster, column, row, 1, 0)) +
                      std::abs(rise(raster, column, row, 0, 1)));
    }
  }
  if (rises.empty()) return 1.0F;
  const auto nth = rises.begin() + static_cast<std::ptrdiff_t>((rises.size() - 1) * 95 / 100);
  std::ranges::nth_element(rises, nth);
  return 0.28F / std::max(*nth, 0.08F);
}

cv::Vec3b scaled(const cv::Vec3b& colour, float factor) {
  cv::Vec3b result;
  for (int i = 0; i < 3; ++i)
    result[i] = cv::saturate_cast<uchar>(static_cast<float>(colour[i]) * factor);
  return result;
}

/// Where many cells share a pixel a wall would be a hairline: there it is drawn two pixels wide.
bool is_obstacle(const MapRaster& raster, int column, int row) {
  if (raster.classes[raster.at(column, row)] == CellClass::obstacle) return true;
  if (raster.cells_per_pixel == 1 || !raster.known(column, row)) return false;
  const auto obstacle_at = [&](int c, int r) {
    return raster.known(c, r) && raster.classes[raster.at(c, r)] == CellClass::obstacle;
  };
  return obstacle_at(column - 1, row) || obstacle_at(column, row - 1);
}

cv::Vec3b unknown_at(int column, int row) {
  return (column + row) % kHatchPx == 0 ? kUnknownHatch : kUnknownColour;
}

}  // namespace

HeightRange tint_range(const MapRaster& raster) {
  std::vector<float> heights;
  for (std::size_t i = 0; i < raster.classes.size(); ++i) {
    if (raster.classes[i] == CellClass::free) heights.push_back(raster.height_m[i]);
  }
  if (heights.empty()) return {-1.0F, 1.0F};
  const auto percentile = [&heights](std::size_t percent) {
    const auto nth =
        heights.begin() + static_cast<std::ptrdiff_t>((heights.size() - 1) * percent / 100);
    std::ranges::nth_element(heights, nth);
    return *nth;
  };
  HeightRange range{percentile(2), percentile(98)};
  if (const float lack = kMinTintSpanM - (range.high_m - range.low_m); lack > 0.0F) {
    range.low_m -= 0.4F * lack;
    range.high_m += 0.6F * lack;
  }
  return range;
}

cv::Vec3b tint(float height_m, const HeightRange& range) {
  const float part = (height_m - range.low_m) / (range.high_m - range.low_m);
  const float place = std::clamp(part, 0.0F, 1.0F) * static_cast<float>(kTints.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), kTints.size() - 2);
  const float rest = place - static_cast<float>(below);
  cv::Vec3b colour;
  for (std::size_t i = 0; i < 3; ++i) {
    const float mixed = kTints[below][i] * (1.0F - rest) + kTints[below + 1][i] * rest;
    colour[static_cast<int>(i)] = cv::saturate_cast<uchar>(mixed);
  }
  return colour;
}

cv::Mat3b draw_relief(const MapRaster& raster, const HeightRange& range, int scale) {
  cv::Mat3b image(raster.height * scale, raster.width * scale);
  const float exaggeration = exaggeration_for(raster);
  for (int row = 0; row < image.rows; ++row) {
    auto* line = image.ptr<cv::Vec3b>(row);
    for (int column = 0; column < image.cols; ++column) {
      const int c = column / scale;
      const int r = row / scale;
      const auto i = raster.at(c, r);
      if (raster.classes[i] == CellClass::unknown) {
        line[column] = unknown_at(column, row);
      } else if (column % scale != 0) {
        line[column] = line[column - 1];
      } else if (is_obstacle(raster, c, r)) {
        line[column] = kObstacleColour;
      } else {
        line[column] = scaled(tint(raster.height_m[i], range), shade(raster, c, r, exaggeration));
      }
    }
  }
  return image;
}

}  // namespace cairn::cli
