#include "core/localization/long_term_relief.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/localization/raster_surroundings.h"

namespace cairn {
namespace {

constexpr int kAround = 2;  // Squares of 5 × 5 cells are looked at.

/// Whether much around is unknown: what is behind was not seen.
bool hides_something(const MatchRaster& raster, int x, int y) {
  constexpr int kHidden = 10;  // Of 25: as many as lie behind a line through the middle.
  int count = 0;
  visit_around(raster, x, y, kAround,
               [&](std::size_t i) { count += raster.height_mm[i] == raster.unknown ? 1 : 0; });
  return count >= kHidden;
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
  relief.ground = ground_under(raster, {search.near_cells, search.far_cells, search.rise_mm});
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
