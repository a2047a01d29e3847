#pragma once

#include <vector>

#include "core/planner/line_cost.h"

namespace cairn {

/// The cells that lead down the field from a reached cell to the goal, both included: of the best
/// triangle's two neighbours the one its way comes nearer to. Every step is one of step_cost.
[[nodiscard]] std::vector<CellIndex> cells_down(const DrivableGrid& grid, const Field& field,
                                                CellIndex start);

/// The direction of the first of those steps. Requires: the cell is reached and not the goal.
[[nodiscard]] int first_step_down(const DrivableGrid& grid, const Field& field, CellIndex cell);

/// A way down the field that keeps no cell's middle (in place of cells_down), from `start_m` to
/// `goal_m`, which lies in the goal's cell. Empty where the field between the cells gives no clear
/// advice; then cells_down does.
[[nodiscard]] std::vector<Eigen::Vector2d> walk_down(const DrivableGrid& grid, const Field& field,
                                                     const LineCost& lines,
                                                     const Eigen::Vector2d& start_m,
                                                     const Eigen::Vector2d& goal_m);

/// The cheapest way over the cells' middles in steps of step_cost (Hart, Nilsson & Raphael 1968,
/// the field being the estimate, which no such way undercuts), both ends included; empty when none
/// costs less than `below` [cost units].
[[nodiscard]] std::vector<CellIndex> cheapest_cells(const DrivableGrid& grid, const Field& field,
                                                    CellIndex start, double below);

}  // namespace cairn
