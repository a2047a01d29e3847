#include "core/localization/raster_surroundings.h"

#include <cstddef>
#include <limits>

namespace cairn {
namespace {

std::vector<std::int16_t> lowest_around(const MatchRaster& raster, int reach) {
  return pick_around(raster, reach, std::numeric_limits<std::int16_t>::max(),
                     [](std::int16_t a, std::int16_t b) { return std::min(a, b); });
}

}  // namespace

bool is_thin(const MatchRaster& raster, const std::vector<char>& marked, int x, int y) {
  constexpr int kThin = 11;  // Of 25: two rows of five and one; half of an area would be 15.
  int count = 0;
  visit_around(raster, x, y, 2, [&](std::size_t i) { count += marked[i]; });
  return count <= kThin;
}

std::vector<std::int16_t> ground_under(const MatchRaster& raster, const GroundSearch& search) {
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

}  // namespace cairn
