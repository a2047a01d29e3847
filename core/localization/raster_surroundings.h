#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/localization/match_raster.h"

/// What lies around the cells of a raster.
namespace cairn {

/// How the ground under what stands on it is found.
struct GroundSearch {
  int near_cells = 6;  ///< The lowest known height so near is the ground,
  int far_cells = 16;  ///< unless there is one within this that is lower by
  int rise_mm = 350;   ///< more than ground rises on the way: then that one.
};

/// The ground under each cell; unknown where nothing near is known. Beside a wall often none was
/// seen: there it is looked for farther away.
[[nodiscard]] std::vector<std::int16_t> ground_under(const MatchRaster& raster,
                                                     const GroundSearch& search);

/// Calls visit(index) for the cells at most `reach` away (a square).
template <class Visit>
void visit_around(const MatchRaster& raster, int x, int y, int reach, const Visit& visit) {
  for (int v = std::max(y - reach, 0); v <= std::min(y + reach, raster.height - 1); ++v) {
    for (int u = std::max(x - reach, 0); u <= std::min(x + reach, raster.width - 1); ++u) {
      visit(raster.index(u, v));
    }
  }
}

/// For each cell the winner (by `pick`) of the square that reaches `reach` cells far; unknown cells
/// count as `nothing`. A square's winner is the winner of its rows' winners.
template <class Pick>
std::vector<std::int16_t> pick_around(const MatchRaster& raster, int reach, std::int16_t nothing,
                                      const Pick& pick) {
  std::vector<std::int16_t> heights = raster.height_mm;
  std::replace(heights.begin(), heights.end(), raster.unknown, nothing);
  std::vector<std::int16_t> picked(heights.size(), nothing);
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      std::int16_t& best = picked[raster.index(x, y)];
      const int last = std::min(x + reach, raster.width - 1);
      for (int u = std::max(x - reach, 0); u <= last; ++u) {
        best = pick(best, heights[raster.index(u, y)]);
      }
    }
  }
  for (int y = 0; y < raster.height; ++y) {
    std::int16_t* row = &heights[raster.index(0, y)];
    std::fill(row, row + raster.width, nothing);
    for (int v = std::max(y - reach, 0); v <= std::min(y + reach, raster.height - 1); ++v) {
      const std::int16_t* other = &picked[raster.index(0, v)];
      for (int x = 0; x < raster.width; ++x) row[x] = pick(row[x], other[x]);
    }
  }
  std::replace(heights.begin(), heights.end(), nothing, raster.unknown);
  return heights;
}

/// Whether few of the cells in the 5 × 5 around are marked: a line of them, not an area.
[[nodiscard]] bool is_thin(const MatchRaster& raster, const std::vector<char>& marked, int x,
                           int y);

}  // namespace cairn
