#pragma once

#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "core/planner/trulla.h"

namespace cairn::test {

/// The textbook's answer, from step_cost alone: the cost [1e-4 m] to drive to the goal from every
/// open cell, kNoWay where there is no way.
inline std::vector<std::uint32_t> plain_dijkstra(const DrivableGrid& grid, CellIndex goal,
                                                 const PlannerConfig& config) {
  using Item = std::pair<std::uint64_t, std::size_t>;
  const int width = grid.heights.width;
  std::vector<std::uint32_t> cost(grid.open.size(), kNoWay);
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  cost[grid.heights.at(goal)] = 0;
  queue.emplace(0, grid.heights.at(goal));
  while (!queue.empty()) {
    const auto [so_far, to] = queue.top();
    queue.pop();
    if (so_far != cost[to]) continue;
    for (int d = 0; d < 8; ++d) {
      const int x = static_cast<int>(to) % width - kStepX[d];
      const int y = static_cast<int>(to) / width - kStepY[d];
      if (x < 0 || y < 0 || x >= width || y >= grid.heights.height) continue;
      const auto from = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x);
      const std::uint32_t step = grid.open[from] ? step_cost(grid, config, from, d) : kNoWay;
      if (step == kNoWay || so_far + step >= cost[from]) continue;
      cost[from] = static_cast<std::uint32_t>(so_far + step);
      queue.emplace(so_far + step, from);
    }
  }
  return cost;
}

}  // namespace cairn::test
