#include "core/localization/match_raster.h"

#include <algorithm>
#include <limits>

namespace cairn {
namespace {

constexpr std::int16_t kNothing = std::numeric_limits<std::int16_t>::max();

/// out[i] = the lowest of in[i - reach … i + reach], `step` apart, `count` of them.
void lowest_in_line(const std::int16_t* in, std::int16_t* out, int count, std::size_t step,
                    int reach) {
  for (int i = 0; i < count; ++i) {
    std::int16_t lowest = kNothing;
    const int last = std::min(i + reach, count - 1);
    for (int k = std::max(i - reach, 0); k <= last; ++k) {
      lowest = std::min(lowest, in[static_cast<std::size_t>(k) * step]);
    }
    out[static_cast<std::size_t>(i) * step] = lowest;
  }
}

void copy_tile(const Tile& tile, std::int64_t left, std::int64_t bottom, MatchRaster& raster) {
  const auto first = [](std::int64_t at) {
    return static_cast<int>(std::clamp<std::int64_t>(-at, 0, Tile::kSize));
  };
  const auto end = [](std::int64_t at, int size) {
    return static_cast<int>(std::clamp<std::int64_t>(size - at, 0, Tile::kSize));
  };
  for (int y = first(bottom); y < end(bottom, raster.height); ++y) {
    for (int x = first(left); x < end(left, raster.width); ++x) {
      const int i = Tile::index(x, y);
      if (!tile.known(i)) continue;
      const std::int64_t above_mm = std::int64_t{tile.height_mm(i)} - raster.datum_mm;
      if (above_mm < -kMatchLimitMm || above_mm > kMatchLimitMm) continue;
      raster.height_mm[raster.index(static_cast<int>(left + x), static_cast<int>(bottom + y))] =
          static_cast<std::int16_t>(above_mm);
    }
  }
}

/// The lowest known height within `reach` cells of each cell (a square).
std::vector<std::int16_t> lowest_around(const MatchRaster& raster, int reach) {
  std::vector<std::int16_t> heights = raster.height_mm;
  std::replace(heights.begin(), heights.end(), raster.unknown, kNothing);
  std::vector<std::int16_t> lowest(heights.size());
  const auto width = static_cast<std::size_t>(raster.width);
  for (int y = 0; y < raster.height; ++y) {
    const std::size_t row = raster.index(0, y);
    lowest_in_line(&heights[row], &lowest[row], raster.width, 1, reach);
  }
  for (std::size_t x = 0; x < width; ++x) {
    lowest_in_line(&lowest[x], &heights[x], raster.height, width, reach);
  }
  return heights;
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
  visit_around(raster, x, y, 2, [&](std::size_t i) { count += marked[i]; });
  return count <= kThin;
}

}  // namespace

std::optional<CellBox> known_box(const HeightMap& map) {
  constexpr auto kMax = std::numeric_limits<std::int32_t>::max();
  CellBox box{{kMax, kMax}, {-kMax, -kMax}};
  for (const auto& [key, tile] : map.tiles()) {
    if (key.level != 0) continue;
    for (int i = 0; i < Tile::kCells; ++i) {
      if (!tile->known(i)) continue;
      const std::int32_t x = key.tx * Tile::kSize + i % Tile::kSize;
      const std::int32_t y = key.ty * Tile::kSize + i / Tile::kSize;
      box.lowest = {std::min(box.lowest.x, x), std::min(box.lowest.y, y)};
      box.highest = {std::max(box.highest.x, x), std::max(box.highest.y, y)};
    }
  }
  return box.lowest.x > box.highest.x ? std::nullopt : std::optional(box);
}

MatchRaster make_raster(const HeightMap& map, CellIndex lowest, int width, int height,
                        std::int32_t datum_mm, std::int16_t unknown) {
  MatchRaster raster{lowest, width, height, datum_mm, unknown, {}};
  raster.height_mm.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                          unknown);
  const TileKey first = HeightMap::tile_of(lowest);
  const TileKey last = HeightMap::tile_of({lowest.x + width - 1, lowest.y + height - 1});
  for (std::int32_t ty = first.ty; ty <= last.ty; ++ty) {
    for (std::int32_t tx = first.tx; tx <= last.tx; ++tx) {
      const Tile* tile = map.find({0, tx, ty});
      if (tile == nullptr) continue;
      copy_tile(*tile, std::int64_t{tx} * Tile::kSize - lowest.x,
                std::int64_t{ty} * Tile::kSize - lowest.y, raster);
    }
  }
  return raster;
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
      if (ground[i] - far[i] <= search.rise_mm || known[i] == 0) continue;
      if (is_thin(raster, known, x, y)) ground[i] = far[i];
    }
  }
  std::replace(ground.begin(), ground.end(), kNothing, raster.unknown);
  return ground;
}

void clip_faces(MatchRaster& raster, const std::vector<std::int16_t>& ground, int face_mm) {
  for (std::size_t i = 0; i < ground.size(); ++i) {
    if (raster.height_mm[i] == raster.unknown) continue;
    const int highest = std::min(ground[i] + face_mm, kMatchLimitMm);
    raster.height_mm[i] = static_cast<std::int16_t>(std::min<int>(raster.height_mm[i], highest));
  }
}

void make_ridges(MatchRaster& raster, const std::vector<std::int16_t>& ground, int face_mm) {
  constexpr int kBehind = 3;
  std::vector<char> face(ground.size());
  for (std::size_t i = 0; i < ground.size(); ++i) {
    const bool known = raster.height_mm[i] != raster.unknown;
    face[i] = known && raster.height_mm[i] - ground[i] > face_mm / 2 ? 1 : 0;
  }
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      if (face[raster.index(x, y)] == 0 || !is_thin(raster, face, x, y)) continue;
      const std::int16_t foot_mm = ground[raster.index(x, y)];
      visit_around(raster, x, y, kBehind, [&](std::size_t i) {
        if (raster.height_mm[i] == raster.unknown) raster.height_mm[i] = foot_mm;
      });
    }
  }
}

}  // namespace cairn
