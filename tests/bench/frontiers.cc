// Finding and ranking the frontiers of a large map.
#include <iostream>
#include <random>

#include "core/frontier/frontier.h"
#include "tests/bench/cpu_time.h"
#include "tests/bench/planning_worlds.h"
#include "tests/bench/report.h"
#include "tests/bench/timing.h"

namespace cairn::bench {
namespace {

constexpr int kSize = 2048;
constexpr int kRuns = 7;

/// Hills of which discs have been seen around a thousand places.
DrivableGrid partly_seen() {
  HeightGrid heights = planning_world("terrain", kSize, 12);
  std::vector<std::uint8_t> seen(heights.probability.size());
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) {
    const int x0 = static_cast<int>(random() % kSize);
    const int y0 = static_cast<int>(random() % kSize);
    const int radius = 10 + static_cast<int>(random() % 40);
    for (int y = std::max(y0 - radius, 0); y < std::min(y0 + radius, kSize); ++y) {
      for (int x = std::max(x0 - radius, 0); x < std::min(x0 + radius, kSize); ++x) {
        const bool near = (x - x0) * (x - x0) + (y - y0) * (y - y0) < radius * radius;
        if (near && random() % 50 != 0) seen[heights.at({x, y})] = 200;
      }
    }
  }
  heights.probability = seen;
  PlannerConfig config;
  config.limits.radius_m = 0.25;
  return make_drivable(std::move(heights), config);
}

Eigen::Vector2d open_middle(const DrivableGrid& grid) {
  CellIndex cell{kSize / 2, kSize / 2};
  while (!grid.open[grid.heights.at(cell)]) ++cell.x;
  const double cell_m = grid.heights.cell_size_mm / 1000.0;
  return {(cell.x + 0.5) * cell_m, (cell.y + 0.5) * cell_m};
}

int run() {
  const DrivableGrid grid = partly_seen();
  const Eigen::Vector2d from_m = open_middle(grid);
  std::vector<Frontier> frontiers;
  const double all_s = least_cpu_s(kRuns, [&] { frontiers = find_frontiers(grid, from_m, {}); });
  Report report("frontiers");
  report.add(
      {"frontiers found", 1.0 * static_cast<double>(frontiers.size()), "", Better::higher, {}, {}});
  report.add({"found, clustered, ranked by way, 2048²", all_s * 1e3, "ms", Better::lower, 25.0});
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main() { return cairn::bench::run(); }
