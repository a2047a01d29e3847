#include "core/localization/turned_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cairn {
namespace {

// Cell coordinates in 1/65536; a step's error of half a unit is 0.02 cells after 2000.
constexpr int kShift = 16;
constexpr double kOne = 65536.0;

/// A straight walk through the short-term raster, one step for each cell of a turned row.
struct Walk {
  std::int64_t x, y, dx, dy;

  [[nodiscard]] bool inside(int step, const MatchRaster& raster) const {
    const std::int64_t u = (x + step * dx) >> kShift;
    const std::int64_t v = (y + step * dy) >> kShift;
    return u >= 0 && v >= 0 && u < raster.width && v < raster.height;
  }
  [[nodiscard]] std::size_t index(int step, const MatchRaster& raster) const {
    return raster.index(static_cast<int>((x + step * dx) >> kShift),
                        static_cast<int>((y + step * dy) >> kShift));
  }
};

struct Steps {
  int first;
  int end;
};

/// Narrows [first, end] to where first_cell + i · step may lie in [0, size).
void narrow(double start, double step, double size, double& first, double& end) {
  if (std::abs(step) < 1e-9) {
    if (start < 0.0 || start > size) end = first - 1.0;
    return;
  }
  const double a = -start / step;
  const double b = (size - start) / step;
  first = std::max(first, std::min(a, b));
  end = std::min(end, std::max(a, b));
}

/// The steps of a walk that lie in the raster: without a gap, as it is convex.
Steps steps_inside(const Walk& walk, const MatchRaster& raster, int count) {
  double first = 0.0;
  double last = count - 1.0;
  narrow(static_cast<double>(walk.x), static_cast<double>(walk.dx), raster.width * kOne, first,
         last);
  narrow(static_cast<double>(walk.y), static_cast<double>(walk.dy), raster.height * kOne, first,
         last);
  if (last < first) return {0, 0};
  Steps steps{static_cast<int>(std::ceil(first)), static_cast<int>(std::floor(last)) + 1};
  while (steps.first < steps.end && !walk.inside(steps.first, raster)) ++steps.first;
  while (steps.first < steps.end && !walk.inside(steps.end - 1, raster)) --steps.end;
  return steps;
}

/// Appends the blocks of one row that hold something.
void append_row(const MatchRaster& short_term, const Walk& walk, int count, std::uint32_t at,
                TurnedMap& turned) {
  const Steps steps = steps_inside(walk, short_term, count);
  if (steps.first == steps.end) return;
  for (int begin = steps.first & ~(TurnedMap::kBlock - 1); begin < steps.end;
       begin += TurnedMap::kBlock) {
    std::array<std::int16_t, TurnedMap::kBlock> block;
    block.fill(kUnknownInShort);
    int highest = kUnknownInShort;
    const int end = std::min(begin + TurnedMap::kBlock, steps.end);
    for (int i = std::max(begin, steps.first); i < end; ++i) {
      const std::int16_t height = short_term.height_mm[walk.index(i, short_term)];
      block[static_cast<std::size_t>(i - begin)] = height;
      highest = std::max<int>(highest, height);
    }
    if (highest == kUnknownInShort) continue;
    turned.height_mm.insert(turned.height_mm.end(), block.begin(), block.end());
    turned.at.push_back(at + static_cast<std::uint32_t>(begin));
  }
}

}  // namespace

TurnedMap turn(const MatchRaster& short_term, const Turning& turning, double yaw_rad) {
  TurnedMap turned;
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  const auto fixed = [](double cells) { return std::llround(cells * kOne); };
  const int left = static_cast<int>(std::floor(turning.pivot_long.x())) - turning.reach - 1;
  const int bottom = static_cast<int>(std::floor(turning.pivot_long.y())) - turning.reach - 1;
  const int count = 2 * turning.reach + 3;
  for (int row = 0; row < count; ++row) {
    const double x = left + 0.5 - turning.pivot_long.x();
    const double y = bottom + row + 0.5 - turning.pivot_long.y();
    const Walk walk{fixed(turning.pivot_short.x() + c * x + s * y),
                    fixed(turning.pivot_short.y() - s * x + c * y), fixed(c), fixed(-s)};
    append_row(short_term, walk, count,
               static_cast<std::uint32_t>((bottom + row) * turning.long_width + left), turned);
  }
  return turned;
}

}  // namespace cairn
