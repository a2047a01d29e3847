#pragma once

#include <cstdint>
#include <vector>

#include "core/common/result.h"
#include "core/map/height_map.h"

namespace cairn {

/// A dense window of a map, row by row from the south-west: what conversion and planning read.
struct HeightGrid {
  CellIndex origin;  ///< The map's cell at (0, 0) of the window.
  int width = 0;
  int height = 0;
  int cell_size_mm = 125;
  std::vector<std::int32_t> height_mm;
  std::vector<std::uint8_t> probability;  ///< 0 = unknown.

  /// [cells] Windows beyond this are refused.
  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 27;

  [[nodiscard]] bool contains(CellIndex c) const {
    const std::int64_t x = std::int64_t{c.x} - origin.x;
    const std::int64_t y = std::int64_t{c.y} - origin.y;
    return x >= 0 && y >= 0 && x < width && y < height;
  }
  /// Requires: contains(c).
  [[nodiscard]] std::size_t at(CellIndex c) const {
    return static_cast<std::size_t>(c.y - origin.y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(c.x - origin.x);
  }
};

/// Cells from `lowest` to `highest`, both included. `exhausted` when beyond kMaxCells;
/// invalid_argument when `highest` is below `lowest` or the cell size is not above 0.
[[nodiscard]] Result<HeightGrid> empty_grid(CellIndex lowest, CellIndex highest, int cell_size_mm);
/// Copies the part of a tile that lies in the grid. Cells below `min_probability` stay unknown.
void draw_tile(HeightGrid& grid, const TileKey& key, const Tile& tile,
               std::uint8_t min_probability);

/// What a vehicle can drive over and where it fits (T4.2: about 0.1 m for the ATRV-Jr).
struct VehicleLimits {
  std::int32_t climb_mm = 100;    ///< Highest step up from one cell to the next. [Limit: ≥ 0]
  std::int32_t descend_mm = 100;  ///< Deepest step down. [Limit: ≥ 0]
  double radius_m =
      0.5;  ///< Centres stay this far from obstacles: it can turn on the spot. [Limit: 0 … 10]

  friend bool operator==(const VehicleLimits&, const VehicleLimits&) = default;
};

enum class CellClass : std::uint8_t { unknown = 0, free = 1, obstacle = 2 };

/// [cells] A change of a height changes no class farther away than this.
inline constexpr int kSplitStepReach = 3;

/// Converts heights to free / obstacle / unknown (T4.3.1): a known cell that stands above one of
/// its eight known neighbours by more than the vehicle can both climb and descend is an obstacle;
/// only the -z difference counts, so a cliff is marked at its top. Steps that the vehicle manages
/// one way only stay free here: the planner forbids the other way.
/// So are steps that the grid has cut in two: where the ground falls by more than the limit over
/// two cells, along any of eight directions, and is level above and below that, the upper cell is
/// an obstacle, and the one between when more than a quarter of the step lies below it. Slopes go
/// on above or below, and stay what they are.
[[nodiscard]] std::vector<CellClass> classify(const HeightGrid& grid, const VehicleLimits& limits);

}  // namespace cairn
