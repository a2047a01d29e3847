#include "core/localization/long_term_relief.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace cairn {
namespace {

constexpr int kAround = 2;  // Squares of 5 × 5 cells are looked at.

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

std::vector<std::int16_t> lowest_around(const MatchRaster& raster, int reach) {
  return pick_around(raster, reach, std::numeric_limits<std::int16_t>::max(),
                     [](std::int16_t a, std::int16_t b) { return std::min(a, b); });
}

/// Calls visit(index) for the cells at most `reach` away.
template <class Visit>
void visit_around(const MatchRaster& raster, int x, int y, int reach, const Visit& visit) {
  for (int v = std::max(y - reach, 0); v <= std::min(y + reach, raster.height - 1); ++v) {
    for (int u = std::max(x - reach, 0); u <= std::min(x + reach, raster.width - 1); ++u) {
      visit(raster.index(u, v));
    }
  }
}

/// Whether few of the cells around are marked: a line of them, not an area.
bool is_thin(const MatchRaster& raster, const std::vector<char>& marked, int x, int y) {
  constexpr int kThin = 11;  // Of 25: two rows of five and one; half of an area would be 15.
  int count = 0;
  visit_around(raster, x, y, kAround, [&](std::size_t i) { count += marked[i]; });
  return count <= kThin;
}

/// Whether much around is unknown: what is behind was not seen.
bool hides_something(const MatchRaster& raster, int x, int y) {
  constexpr int kHidden = 10;  // Of 25: as many as lie behind a line through the middle.
  int count = 0;
  visit_around(raster, x, y, kAround,
               [&](std::size_t i) { count += raster.height_mm[i] == raster.unknown ? 1 : 0; });
  return count >= kHidden;
}

/// The ground under each cell. Beside a wall often none was seen: there it is looked for farther
/// away.
std::vector<std::int16_t> ground_under(const MatchRaster& raster, const FaceSearch& search) {
  std::vector<std::int16_t> ground = lowest_around(raster, search.near_cells);
  const std::vector<std::int16_t> far = lowest_around(raster, search.far_cells);
  std::vector<char> known(ground.size());
  for (std::size_t i = 0; i < ground.size(); ++i) {
    known[i] = raster.height_mm[i] != raster.unknown ? 1 : 0;
  }
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      const std::size_t i = raster.index(x, y);
      if (known[i] == 0 || ground[i] - far[i] <= search.rise_mm) continue;
      if (is_thin(raster, known, x, y)) ground[i] = far[i];
    }
  }
  return ground;
}

/// Cells of faces that were only seen from the side.
std::vector<char> side_faces(const MatchRaster& raster, const std::vector<std::int16_t>& ground,
                             int face_mm) {
  std::vector<char> high(ground.size());
  for (std::size_t i = 0; i < ground.size(); ++i) {
    const bool known = raster.height_mm[i] != raster.unknown;
    high[i] = known && raster.height_mm[i] - ground[i] > face_mm / 2 ? 1 : 0;
  }
  std::vector<char> faces(high.size());
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      const std::size_t i = raster.index(x, y);
      if (high[i] == 0) continue;
      faces[i] = is_thin(raster, high, x, y) && hides_something(raster, x, y) ? 1 : 0;
    }
  }
  return faces;
}

}  // namespace

double LongTermRelief::limit_mm(int x, int y, double other_top_mm) const {
  const std::size_t i = heights.index(x, y);
  const double seen_in_both_mm = std::min<double>(top[i], other_top_mm);
  return std::max<double>(seen_in_both_mm, ground[i] + face_mm);
}

LongTermRelief make_relief(MatchRaster heights, const FaceSearch& search, double cell_m) {
  constexpr int kBehind = 3;  // Cells that the ground goes on behind a face.
  LongTermRelief relief{std::move(heights), {}, {}, {}, search.face_mm, cell_m};
  MatchRaster& raster = relief.heights;
  relief.ground = ground_under(raster, search);
  relief.top = highest_around(raster);
  const std::vector<char> faces = side_faces(raster, relief.ground, search.face_mm);
  relief.face.assign(faces.size(), 0);
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      const std::size_t face = raster.index(x, y);
      if (faces[face] == 0) continue;
      visit_around(raster, x, y, 1, [&](std::size_t i) { relief.face[i] = 1; });
      visit_around(raster, x, y, kBehind, [&](std::size_t i) {
        if (raster.height_mm[i] == raster.unknown) raster.height_mm[i] = relief.ground[face];
      });
    }
  }
  return relief;
}

std::vector<std::int16_t> highest_around(const MatchRaster& raster) {
  return pick_around(raster, kAround, std::numeric_limits<std::int16_t>::min(),
                     [](std::int16_t a, std::int16_t b) { return std::max(a, b); });
}

}  // namespace cairn
