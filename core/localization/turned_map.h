#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/localization/match_raster.h"

namespace cairn {

/// A short-term map turned onto the site's grid: only its blocks of 32 cells in a row that hold a
/// known one.
struct TurnedMap {
  static constexpr int kBlock = 32;

  std::vector<std::int16_t> height_mm;  ///< kBlock for each block.
  std::vector<std::uint32_t> at;        ///< Each block's first cell in the long-term raster.

  [[nodiscard]] int blocks() const { return static_cast<int>(at.size()); }
  [[nodiscard]] std::uint32_t cells() const {
    return static_cast<std::uint32_t>(at.size()) * kBlock;
  }
};

/// Where a short-term map is turned and how it lies in the long-term raster.
struct Turning {
  Eigen::Vector2d pivot_short;  ///< [cells] The point that stays, in the short-term raster.
  Eigen::Vector2d pivot_long;   ///< [cells] The same in the long-term raster, at shift (0, 0).
  int long_width = 0;           ///< Of the long-term raster.
  int reach = 0;                ///< [cells] No known cell lies farther from the pivot.
};

/// Takes for each cell the short-term map's cell under its middle.
/// Requires: the long-term raster holds reach + 1 + kBlock cells around the pivot.
[[nodiscard]] TurnedMap turn(const MatchRaster& short_term, const Turning& turning, double yaw_rad);

}  // namespace cairn
