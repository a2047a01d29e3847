#include "core/localization/match_raster.h"

#include <algorithm>
#include <limits>

namespace cairn {
namespace {

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

}  // namespace

std::optional<MapBox> known_box(const HeightMap& map) {
  constexpr auto kMax = std::numeric_limits<std::int32_t>::max();
  MapBox box{{kMax, kMax}, {-kMax, -kMax}};
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

}  // namespace cairn
