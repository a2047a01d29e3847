#pragma once

#include <cstdint>

namespace cairn {

/// One cell of a 2½-D map (T4.3): the height of the tallest surface and the probability that it is
/// there. Probability is in 1/255; 0 = unknown (the height then means nothing).
struct Cell {
  std::int32_t height_mm = 0;  ///< Above the site's origin.
  std::uint8_t probability = 0;

  [[nodiscard]] bool known() const { return probability != 0; }
  friend bool operator==(const Cell&, const Cell&) = default;
};

/// Position of a cell in a map's unbounded grid: cell (0, 0) covers [0, cell) × [0, cell).
struct CellIndex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  friend bool operator==(const CellIndex&, const CellIndex&) = default;
};

}  // namespace cairn
