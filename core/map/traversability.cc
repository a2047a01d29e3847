#include "core/map/traversability.h"

#include <algorithm>

#include "core/map/soft_ground.h"
#include "core/map/terrain_kernels.h"

namespace cairn {

Result<HeightGrid> empty_grid(CellIndex lowest, CellIndex highest, int cell_size_mm) {
  if (cell_size_mm <= 0) {
    return Error{ErrorCode::invalid_argument, "a grid needs a cell size above 0 mm"};
  }
  const std::int64_t width = std::int64_t{highest.x} - lowest.x + 1;
  const std::int64_t height = std::int64_t{highest.y} - lowest.y + 1;
  if (width <= 0 || height <= 0) {
    return Error{ErrorCode::invalid_argument, "a grid's highest cell must not be below its lowest"};
  }
  if (width > HeightGrid::kMaxCells / height) {
    return Error{ErrorCode::exhausted, "the window has more than " +
                                           std::to_string(HeightGrid::kMaxCells) +
                                           " cells: ask for a smaller one"};
  }
  const auto cells = static_cast<std::size_t>(width * height);
  return HeightGrid{
      lowest,       static_cast<int>(width),          static_cast<int>(height),
      cell_size_mm, std::vector<std::int32_t>(cells), std::vector<std::uint8_t>(cells)};
}

void draw_tile(HeightGrid& grid, const TileKey& key, const Tile& tile,
               std::uint8_t min_probability) {
  const std::int64_t left = std::int64_t{key.tx} * Tile::kSize - grid.origin.x;
  const std::int64_t bottom = std::int64_t{key.ty} * Tile::kSize - grid.origin.y;
  const auto first = [](std::int64_t offset) { return std::clamp<std::int64_t>(-offset, 0, 64); };
  const auto last = [](std::int64_t offset, int size) {
    return std::clamp<std::int64_t>(size - offset, 0, Tile::kSize);
  };
  for (std::int64_t y = first(bottom); y < last(bottom, grid.height); ++y) {
    for (std::int64_t x = first(left); x < last(left, grid.width); ++x) {
      const int i = Tile::index(static_cast<int>(x), static_cast<int>(y));
      const bool believed = tile.known(i) && tile.probability(i) >= min_probability;
      const auto at = static_cast<std::size_t>((bottom + y) * grid.width + left + x);
      grid.height_mm[at] = believed ? tile.height_mm(i) : 0;
      grid.probability[at] = believed ? tile.probability(i) : std::uint8_t{0};
    }
  }
}

std::vector<CellClass> classify(const HeightGrid& grid, const VehicleLimits& limits) {
  std::vector<CellClass> classes(grid.height_mm.size());
  TerrainAnswers answers;
  answers.classes = classes.data();
  judge_terrain(grid, terrain_rules(grid.cell_size_mm, limits, {}), answers,
                *usable_terrain_kernels().front());
  return classes;
}

}  // namespace cairn
