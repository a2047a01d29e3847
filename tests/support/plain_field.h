#pragma once

#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "core/planner/stencil.h"
#include "core/planner/trulla.h"

namespace cairn::test {

/// A grid's cells, row by row from the south-west.
inline std::vector<CellIndex> cells_of(const HeightGrid& heights) {
  std::vector<CellIndex> cells;
  for (int y = 0; y < heights.height; ++y) {
    for (int x = 0; x < heights.width; ++x) {
      cells.push_back({heights.origin.x + x, heights.origin.y + y});
    }
  }
  return cells;
}

/// cost_to_goal of every cell, row by row.
inline std::vector<std::uint32_t> costs(const DrivableGrid& grid, const Field& field) {
  std::vector<std::uint32_t> all;
  for (const CellIndex cell : cells_of(grid.heights)) {
    all.push_back(cost_to_goal(grid, field, cell));
  }
  return all;
}

/// The textbook's answer in steps from cell to cell, from step_cost alone (Dijkstra 1959).
inline std::vector<std::uint32_t> plain_dijkstra(const DrivableGrid& grid, CellIndex goal) {
  using Item = std::pair<std::uint64_t, std::size_t>;
  const std::vector<CellIndex> cells = cells_of(grid.heights);
  std::vector<std::uint32_t> cost(cells.size(), kNoWay);
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  cost[grid.heights.at(goal)] = 0;
  queue.emplace(0, grid.heights.at(goal));
  while (!queue.empty()) {
    const auto [so_far, to] = queue.top();
    queue.pop();
    if (so_far != cost[to]) continue;
    for (int d = 0; d < 8; ++d) {
      const CellIndex from{cells[to].x - kStepX[d], cells[to].y - kStepY[d]};
      const std::uint32_t step = step_cost(grid, from, d);
      if (step == kNoWay || so_far + step >= cost[grid.heights.at(from)]) continue;
      cost[grid.heights.at(from)] = static_cast<std::uint32_t>(so_far + step);
      queue.emplace(so_far + step, grid.heights.at(from));
    }
  }
  return cost;
}

/// What a cell costs by its neighbours, straight from the definition of Field.
inline std::uint32_t best_triangle(const DrivableGrid& grid, const std::vector<std::uint32_t>& cost,
                                   CellIndex cell) {
  constexpr std::int32_t kNone = 1 << 30;
  const std::int32_t price = grid.ground.price[grid.ground_at(cell)] & PricedGround::kPriceMask;
  const auto offer = [&](int d) {
    const std::uint32_t step = step_cost(grid, cell, d);
    const CellIndex next{cell.x + kStepX[d], cell.y + kStepY[d]};
    if (step == kNoWay || cost[grid.heights.at(next)] == kNoWay) return kNone;
    const std::int32_t length = (d & 1) != 0 ? diagonal_units(price) : price;
    return static_cast<std::int32_t>(cost[grid.heights.at(next)] + step) - length;
  };
  std::int32_t best = kNone;
  for (int d = 0; d < 8; d += 2) {
    for (const int beside : {(d + 1) & 7, (d + 7) & 7}) {
      best = std::min(best, through_triangle(offer(d), offer(beside), price));
    }
  }
  return best < Field::kUnreached ? static_cast<std::uint32_t>(best) : kNoWay;
}

/// The field by going over all cells until none changes.
inline std::vector<std::uint32_t> plain_field(const DrivableGrid& grid, CellIndex goal) {
  const std::vector<CellIndex> cells = cells_of(grid.heights);
  std::vector<std::uint32_t> cost(cells.size(), kNoWay);
  cost[grid.heights.at(goal)] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::uint32_t now = grid.open[i] ? best_triangle(grid, cost, cells[i]) : kNoWay;
      if (now >= cost[i]) continue;
      cost[i] = now;
      changed = true;
    }
  }
  return cost;
}

}  // namespace cairn::test
