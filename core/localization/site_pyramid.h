#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/localization/site_ground.h"

namespace cairn {

/// A cell of a short-term map turned onto the site's axes, as seen from the cell the robot is in.
struct SitePoint {
  std::int16_t x = 0;  ///< [cells]
  std::int16_t y = 0;  ///< [cells]
  /// [units] Above the robot's foot; what is far away is known less exactly.
  std::int16_t lowest = 0;
  std::int16_t highest = 0;
};

/// [units] The least that a point can differ from what is there. Fits 16 bits on the way.
[[nodiscard]] inline std::int16_t least_difference(const SitePoint& point, const HeightSpan& there,
                                                   const FloorSpan& floor) {
  const auto below = static_cast<std::int16_t>(point.lowest + floor.lowest - there.highest);
  const auto above = static_cast<std::int16_t>(there.lowest - point.highest - floor.highest);
  std::int16_t apart = below > above ? below : above;
  apart = apart > 0 ? apart : std::int16_t{0};
  return apart < there.most ? apart : there.most;
}

/// For blocks of 2^level × 2^level places of the robot, level 0 … kTop, what any point can meet
/// from any of them when it may also lie one cell beside: so every score in a block, at turns that
/// move no point by more than a cell, is bounded from below by one sum.
class SitePyramid {
 public:
  static constexpr int kTop = 4;
  static constexpr int kTopCells = 1 << kTop;

  explicit SitePyramid(const SiteGround& ground);

  /// [units] Sum of the least differences of points from a robot somewhere in the block that begins
  /// in cell (x, y); stops above `limit`. Requires: floor there; no point leaves the rectangle.
  [[nodiscard]] std::uint32_t bound(int level, int x, int y, const std::vector<SitePoint>& points,
                                    std::uint32_t limit) const;

  [[nodiscard]] const FloorSpan& floor(int level, int x, int y) const {
    return levels_[static_cast<std::size_t>(level)].floor.at(x, y);
  }

  /// Blocks of the top level: block (i, j) begins in cell (margin + i · kTopCells, the same in y).
  [[nodiscard]] int top_columns() const { return columns_; }
  [[nodiscard]] int top_rows() const { return rows_; }
  /// [cells] Columns of `top_bounds`, a few more than there are.
  [[nodiscard]] int top_stride() const { return stride_; }
  /// The bounds of all top blocks, row by row; those without floor mean nothing.
  /// Requires: at most kMostTopPoints points.
  void top_bounds(const std::vector<SitePoint>& points, std::vector<std::uint16_t>& sums) const;

  /// So that sums fit 16 bits.
  static constexpr std::size_t kMostTopPoints = 480;

 private:
  struct Level {
    SiteGrid<HeightSpan> heights;
    SiteGrid<FloorSpan> floor;
  };
  /// Every kTopCells-th cell of the top level from one of the first kTopCells² cells on.
  struct Plane {
    std::vector<std::int16_t> lowest, highest, most;
  };

  void make_planes(const SiteGround& ground);
  [[nodiscard]] const Plane& plane(int x, int y) const {
    const auto row = static_cast<std::size_t>(y % kTopCells);
    return planes_[row * kTopCells + static_cast<std::size_t>(x % kTopCells)];
  }

  std::array<Level, kTop + 1> levels_;
  std::vector<Plane> planes_;
  std::vector<std::int16_t> top_lowest_, top_highest_;  ///< Floor of the top blocks.
  int margin_ = 0;
  int columns_ = 0, rows_ = 0, stride_ = 0;
  int plane_width_ = 0, plane_height_ = 0;
};

}  // namespace cairn
