#include "client/cli/map_raster.h"

#include <algorithm>
#include <cstddef>
#include <unordered_map>

namespace cairn::cli {

namespace {

using TileTable = std::unordered_map<TileKey, const Tile*, TileKeyHash>;

TileTable ground_tiles(const SiteMap& map) {
  TileTable table;
  for (const auto& [key, tile] : map.tiles) {
    if (key.level == 0) table.emplace(key, &tile);
  }
  return table;
}

CellIndex first_cell(const TileKey& key) { return {key.tx * Tile::kSize, key.ty * Tile::kSize}; }

/// A tile with the cells around it, which decide about obstacles at its edge.
HeightGrid with_surroundings(const TileTable& tiles, const TileKey& key, int cell_size_mm) {
  const auto first = first_cell(key);
  auto grid = empty_grid({first.x - 1, first.y - 1}, {first.x + Tile::kSize, first.y + Tile::kSize},
                         cell_size_mm)
                  .value();
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const TileKey near{key.level, key.tx + dx, key.ty + dy};
      if (const auto found = tiles.find(near); found != tiles.end()) {
        draw_tile(grid, near, *found->second, 1);
      }
    }
  }
  return grid;
}

/// Adds up heights; the mean is taken when all tiles are in.
class Accumulator {
 public:
  Accumulator(const CellWindow& window, int cells_per_pixel) : window_(window) {
    const auto pixels = [&](std::int64_t cells) {
      return static_cast<int>((cells + cells_per_pixel - 1) / cells_per_pixel);
    };
    raster_.width = pixels(window.width());
    raster_.height = pixels(window.height());
    raster_.cells_per_pixel = cells_per_pixel;
    const auto size = raster_.at(0, raster_.height);
    raster_.classes.assign(size, CellClass::unknown);
    raster_.height_m.assign(size, 0.0F);
    cells_.assign(size, 0);
  }

  void add(CellIndex cell, std::int32_t height_mm, CellClass cell_class) {
    const auto east = std::int64_t{cell.x} - window_.lowest.x;
    const auto south = std::int64_t{window_.highest.y} - cell.y;
    if (east < 0 || south < 0 || east >= window_.width() || south >= window_.height()) return;
    const auto i = raster_.at(static_cast<int>(east / raster_.cells_per_pixel),
                              static_cast<int>(south / raster_.cells_per_pixel));
    raster_.classes[i] = std::max(raster_.classes[i], cell_class);
    raster_.height_m[i] += static_cast<float>(height_mm) * 1e-3F;
    ++cells_[i];
  }

  MapRaster finish() {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (cells_[i] > 1) raster_.height_m[i] /= static_cast<float>(cells_[i]);
    }
    return std::move(raster_);
  }

 private:
  CellWindow window_;
  MapRaster raster_;
  std::vector<std::uint32_t> cells_;
};

}  // namespace

void CellWindow::add(CellIndex cell) {
  lowest = {std::min(lowest.x, cell.x), std::min(lowest.y, cell.y)};
  highest = {std::max(highest.x, cell.x), std::max(highest.y, cell.y)};
}

CellWindow known_window(const SiteMap& map) {
  CellWindow window;
  for (const auto& [key, tile] : map.tiles) {
    if (key.level != 0) continue;
    const auto first = first_cell(key);
    for (int i = 0; i < Tile::kCells; ++i) {
      if (tile.known(i)) window.add({first.x + i % Tile::kSize, first.y + i / Tile::kSize});
    }
  }
  return window;
}

MapRaster rasterize(const SiteMap& map, const CellWindow& window, int cells_per_pixel) {
  const VehicleLimits limits{map.head.climb_mm, map.head.descend_mm};
  const auto tiles = ground_tiles(map);
  Accumulator sum(window, cells_per_pixel);
  for (const auto& [key, tile] : tiles) {
    const auto grid = with_surroundings(tiles, key, map.head.cell_size_mm);
    const auto classes = classify(grid, limits);
    const auto first = first_cell(key);
    for (int i = 0; i < Tile::kCells; ++i) {
      const CellIndex cell{first.x + i % Tile::kSize, first.y + i / Tile::kSize};
      if (tile->known(i)) sum.add(cell, tile->height_mm(i), classes[grid.at(cell)]);
    }
  }
  return sum.finish();
}

}  // namespace cairn::cli
