#include "core/map/traversability.h"

#include <algorithm>
#include <limits>

#include "core/map/split_steps.h"

namespace cairn {
namespace {

/// Stands for "nothing known here" where the lowest of several heights is wanted.
constexpr std::int32_t kNoHeight = std::numeric_limits<std::int32_t>::max();

std::size_t row_start(const HeightGrid& grid, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width);
}

/// `lowest[x]` becomes the lowest known height of cells x - 1, x and x + 1 of row y.
/// `padded` has room for the row and one cell more on either side.
void lowest_of_three(const HeightGrid& grid, int y, std::vector<std::int32_t>& padded,
                     std::vector<std::int32_t>& lowest) {
  const auto width = static_cast<std::size_t>(grid.width);
  const std::int32_t* height = grid.height_mm.data() + row_start(grid, y);
  const std::uint8_t* probability = grid.probability.data() + row_start(grid, y);
  for (std::size_t x = 0; x < width; ++x) {
    padded[x + 1] = probability[x] != 0 ? height[x] : kNoHeight;
  }
  for (std::size_t x = 0; x < width; ++x) {
    lowest[x] = std::min(std::min(padded[x], padded[x + 1]), padded[x + 2]);
  }
}

/// Classes of row y from the lowest heights of the row below it, its own and the one above it.
void classify_row(const HeightGrid& grid, int y, std::uint32_t step_limit_mm,
                  const std::vector<std::int32_t>& below, const std::vector<std::int32_t>& own,
                  const std::vector<std::int32_t>& above, CellClass* classes) {
  const std::int32_t* height = grid.height_mm.data() + row_start(grid, y);
  const std::uint8_t* probability = grid.probability.data() + row_start(grid, y);
  for (std::size_t x = 0; x < static_cast<std::size_t>(grid.width); ++x) {
    const std::int32_t lowest = std::min(std::min(below[x], own[x]), above[x]);
    // A known cell is one of those, so the drop is not negative and fits 32 bits without a sign.
    const auto drop_mm = static_cast<std::uint32_t>(height[x]) - static_cast<std::uint32_t>(lowest);
    const CellClass known = drop_mm > step_limit_mm ? CellClass::obstacle : CellClass::free;
    classes[x] = probability[x] != 0 ? known : CellClass::unknown;
  }
}

}  // namespace

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
  const auto width = static_cast<std::size_t>(grid.width);
  const auto step_limit_mm =
      static_cast<std::uint32_t>(std::max({limits.climb_mm, limits.descend_mm, 0}));
  std::vector<std::int32_t> padded(width + 2, kNoHeight);
  std::vector<std::int32_t> below(width, kNoHeight);
  std::vector<std::int32_t> own(width, kNoHeight);
  std::vector<std::int32_t> above(width, kNoHeight);
  if (grid.height > 0) lowest_of_three(grid, 0, padded, above);
  for (int y = 0; y < grid.height; ++y) {
    below.swap(own);
    own.swap(above);
    if (y + 1 < grid.height) {
      lowest_of_three(grid, y + 1, padded, above);
    } else {
      std::fill(above.begin(), above.end(), kNoHeight);
    }
    classify_row(grid, y, step_limit_mm, below, own, above, classes.data() + row_start(grid, y));
  }
  mark_split_steps(grid, static_cast<std::int32_t>(step_limit_mm), classes);
  return classes;
}

}  // namespace cairn
