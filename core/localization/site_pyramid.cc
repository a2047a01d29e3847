#include "core/localization/site_pyramid.h"

#include <algorithm>
#include <cassert>

namespace cairn {
namespace {

HeightSpan joined(const HeightSpan& a, const HeightSpan& b) {
  return {std::min(a.lowest, b.lowest), std::max(a.highest, b.highest), std::min(a.most, b.most)};
}

FloorSpan joined(const FloorSpan& a, const FloorSpan& b) {
  return {std::min(a.lowest, b.lowest), std::max(a.highest, b.highest)};
}

/// Each cell with those `step` to the east, north and north-east; at the edge with those there are.
template <class T>
SiteGrid<T> doubled(const SiteGrid<T>& grid, int step) {
  SiteGrid<T> next = grid;
  for (int y = 0; y < grid.height; ++y) {
    const int v = std::min(y + step, grid.height - 1);
    for (int x = 0; x < grid.width; ++x) {
      const int u = std::min(x + step, grid.width - 1);
      next.at(x, y) =
          joined(joined(grid.at(x, y), grid.at(u, y)), joined(grid.at(x, v), grid.at(u, v)));
    }
  }
  return next;
}

/// Each cell with its eight neighbours.
SiteGrid<HeightSpan> with_neighbours(const SiteGrid<HeightSpan>& grid) {
  SiteGrid<HeightSpan> rows = grid;
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 1; x + 1 < grid.width; ++x) {
      rows.at(x, y) = joined(joined(grid.at(x - 1, y), grid.at(x, y)), grid.at(x + 1, y));
    }
  }
  SiteGrid<HeightSpan> all = rows;
  for (int y = 1; y + 1 < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      all.at(x, y) = joined(joined(rows.at(x, y - 1), rows.at(x, y)), rows.at(x, y + 1));
    }
  }
  return all;
}

/// One point's part of the bounds of all top blocks: rows of 16 blocks' multiples.
struct TopPart {
  const std::int16_t* lowest;
  const std::int16_t* highest;
  const std::int16_t* most;
  int plane_width;
  const std::int16_t* floor_lowest;
  const std::int16_t* floor_highest;
  std::uint16_t* sums;
  int columns, rows;
  SitePoint point;
};

/// Written so that compilers make whole vectors of it.
__attribute__((always_inline)) inline void add_rows(const TopPart& part) {
  for (int row = 0; row < part.rows; ++row) {
    const std::ptrdiff_t there = std::ptrdiff_t{row} * part.plane_width;
    const std::ptrdiff_t here = std::ptrdiff_t{row} * part.columns;
    const std::int16_t* __restrict lowest = part.lowest + there;
    const std::int16_t* __restrict highest = part.highest + there;
    const std::int16_t* __restrict most = part.most + there;
    const std::int16_t* __restrict floor_lowest = part.floor_lowest + here;
    const std::int16_t* __restrict floor_highest = part.floor_highest + here;
    std::uint16_t* __restrict sums = part.sums + here;
    for (int i = 0; i < part.columns; ++i) {
      const auto apart = least_difference(part.point, {lowest[i], highest[i], most[i]},
                                          {floor_lowest[i], floor_highest[i]});
      sums[i] = static_cast<std::uint16_t>(sums[i] + static_cast<std::uint16_t>(apart));
    }
  }
}

using AddRows = void (*)(const TopPart&);

__attribute__((optimize("O3"))) void add_rows_portable(const TopPart& part) { add_rows(part); }

#if defined(__x86_64__)
__attribute__((target("avx2"), optimize("O3"))) void add_rows_avx2(const TopPart& part) {
  add_rows(part);
}
AddRows fastest_add_rows() {
  return __builtin_cpu_supports("avx2") ? add_rows_avx2 : add_rows_portable;
}
#else
AddRows fastest_add_rows() { return add_rows_portable; }
#endif

constexpr int kLanes = 16;

}  // namespace

SitePyramid::SitePyramid(const SiteGround& ground) : margin_(ground.margin) {
  levels_[0] = {with_neighbours(ground.heights), ground.floor};
  for (std::size_t level = 0; level < kTop; ++level) {
    levels_[level + 1] = {doubled(levels_[level].heights, 1 << level),
                          doubled(levels_[level].floor, 1 << level)};
  }
  make_planes(ground);
}

void SitePyramid::make_planes(const SiteGround& ground) {
  const int inner_width = ground.heights.width - 2 * margin_;
  const int inner_height = ground.heights.height - 2 * margin_;
  columns_ = (inner_width + kTopCells - 1) / kTopCells;
  rows_ = (inner_height + kTopCells - 1) / kTopCells;
  stride_ = (columns_ + kLanes - 1) / kLanes * kLanes;
  // A row read from its last column on still has `stride_` blocks behind it.
  plane_width_ = (2 * margin_) / kTopCells + stride_ + 2;
  plane_height_ = (2 * margin_) / kTopCells + rows_ + 2;
  const Level& top = levels_[kTop];
  const auto size =
      static_cast<std::size_t>(plane_width_) * static_cast<std::size_t>(plane_height_);
  planes_.reserve(static_cast<std::size_t>(kTopCells) * kTopCells);
  for (int y = 0; y < kTopCells; ++y) {
    for (int x = 0; x < kTopCells; ++x) {
      Plane plane{std::vector<std::int16_t>(size), std::vector<std::int16_t>(size),
                  std::vector<std::int16_t>(size)};
      for (int j = 0; j < plane_height_; ++j) {
        for (int i = 0; i < plane_width_; ++i) {
          const HeightSpan& span =
              top.heights.at(std::min(x + i * kTopCells, top.heights.width - 1),
                             std::min(y + j * kTopCells, top.heights.height - 1));
          const auto k = static_cast<std::size_t>(j) * static_cast<std::size_t>(plane_width_) +
                         static_cast<std::size_t>(i);
          plane.lowest[k] = span.lowest;
          plane.highest[k] = span.highest;
          plane.most[k] = span.most;
        }
      }
      planes_.push_back(std::move(plane));
    }
  }
  const auto blocks = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows_);
  top_lowest_.assign(blocks, kNoHeight);
  top_highest_.assign(blocks, -kNoHeight);
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      const FloorSpan& span = floor(kTop, margin_ + i * kTopCells, margin_ + j * kTopCells);
      const auto k = static_cast<std::size_t>(j) * static_cast<std::size_t>(stride_) +
                     static_cast<std::size_t>(i);
      top_lowest_[k] = span.lowest;
      top_highest_[k] = span.highest;
    }
  }
}

std::uint32_t SitePyramid::bound(int level, int x, int y, const std::vector<SitePoint>& points,
                                 std::uint32_t limit) const {
  constexpr std::size_t kAtOnce = 32;
  const Level& spans = levels_[static_cast<std::size_t>(level)];
  const FloorSpan floor = spans.floor.at(x, y);
  const HeightSpan* const here = &spans.heights.at(x, y);
  const std::ptrdiff_t width = spans.heights.width;
  std::uint32_t sum = 0;
  for (std::size_t begin = 0; begin < points.size() && sum <= limit; begin += kAtOnce) {
    const std::size_t end = std::min(begin + kAtOnce, points.size());
    for (std::size_t i = begin; i < end; ++i) {
      const SitePoint& point = points[i];
      sum += static_cast<std::uint32_t>(
          least_difference(point, here[point.y * width + point.x], floor));
    }
  }
  return sum;
}

void SitePyramid::top_bounds(const std::vector<SitePoint>& points,
                             std::vector<std::uint16_t>& sums) const {
  assert(points.size() <= kMostTopPoints);
  static const AddRows add = fastest_add_rows();
  sums.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows_), 0);
  for (const SitePoint& point : points) {
    const int x = margin_ + point.x;
    const int y = margin_ + point.y;
    assert(x >= 0 && y >= 0 && x <= 2 * margin_ && y <= 2 * margin_);
    const Plane& cells = plane(x, y);
    const std::ptrdiff_t at = std::ptrdiff_t{y / kTopCells} * plane_width_ + x / kTopCells;
    add({cells.lowest.data() + at, cells.highest.data() + at, cells.most.data() + at, plane_width_,
         top_lowest_.data(), top_highest_.data(), sums.data(), stride_, rows_, point});
  }
}

}  // namespace cairn
