#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "core/planner/trulla.h"

namespace cairn {

/// Every cell that a straight line touches, borders and corners included: column by column one run
/// of rows. A line nearer to a cell than a millionth of a cell counts as touching it.
class TouchedCells {
 public:
  /// Requires: finite coordinates within HeightMap::kMaxExtentM, cell_m > 0.
  TouchedCells(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, double cell_m);

  /// Whether holds(CellIndex) for every cell; stops at the first for which it does not.
  template <class Holds>
  [[nodiscard]] bool all(Holds&& holds) const {
    for (std::int32_t x = first_column_; x <= last_column_; ++x) {
      const Rows rows = rows_of(x);
      for (std::int32_t y = rows.lowest; y <= rows.highest; ++y) {
        if (!holds(CellIndex{x, y})) return false;
      }
    }
    return true;
  }

  /// Whether holds(from, to) for every two touched neighbours, in the direction of travel.
  template <class Holds>
  [[nodiscard]] bool all_steps(Holds&& holds) const {
    return all([&](CellIndex cell) {
      const bool up = cell.y == rows_of(cell.x).highest || step_holds(cell, 0, 1, holds);
      if (!up || cell.x == last_column_) return up;
      const Rows next = rows_of(cell.x + 1);
      const std::int32_t lowest = std::max(next.lowest, cell.y - 1);
      const std::int32_t highest = std::min(next.highest, cell.y + 1);
      for (std::int32_t y = lowest; y <= highest; ++y) {
        if (!step_holds(cell, 1, y - cell.y, holds)) return false;
      }
      return true;
    });
  }

 private:
  struct Rows {
    std::int32_t lowest;
    std::int32_t highest;
  };

  [[nodiscard]] Rows rows_of(std::int32_t column) const;
  /// Neighbours that lie side by side in the line's way are not stepped between.
  template <class Holds>
  [[nodiscard]] bool step_holds(CellIndex cell, int dx, int dy, Holds&& holds) const {
    const double ahead = way_.dot(Eigen::Vector2d(dx, dy));
    const CellIndex other{cell.x + dx, cell.y + dy};
    return ahead == 0.0 || (ahead > 0.0 ? holds(cell, other) : holds(other, cell));
  }

  Eigen::Vector2d way_;
  Eigen::Vector2d west_;  ///< [cells]
  Eigen::Vector2d east_;  ///< [cells]
  std::int32_t first_column_ = 0;
  std::int32_t last_column_ = 0;
};

/// Whether every step along the line keeps the limits of climbing and descending. Ground outside
/// the grid or unknown sets none.
[[nodiscard]] bool steps_within_limits(const DrivableGrid& grid, const TouchedCells& line);

}  // namespace cairn
