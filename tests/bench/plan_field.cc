// How fast a whole field is, on one thread, against Dijkstra's search with buckets in the same run;
// and whether what it reaches is exactly what a breadth-first search reaches.
//   bench_plan_field [SIZE]
#include <cmath>
#include <cstdlib>
#include <iostream>

#include "core/planner/tile_wave.h"
#include "tests/bench/cpu_time.h"
#include "tests/bench/planning_worlds.h"
#include "tests/bench/report.h"
#include "tests/bench/timing.h"
#include "tests/support/bucket_dijkstra.h"

namespace cairn::bench {
namespace {

constexpr int kRuns = 5;

/// Nav2's NavFn, times faster than Dijkstra's search with buckets, as measured beside each other.
const std::map<std::string, double> kNavfn = {
    {"open", 1.3}, {"random", 1.1}, {"city", 1.06}, {"maze", 1.0}, {"terrain", 1.35}};
const std::map<std::string, double> kGoals = {
    {"open", 3.0}, {"random", 1.6}, {"city", 1.6}, {"maze", 1.6}, {"terrain", 2.5}};

/// Prices for the peer, which knows no heights: rougher is dearer.
std::vector<float> prices(const DrivableGrid& grid) {
  std::vector<float> price(grid.open.size());
  const int width = grid.heights.width;
  for (int y = 1; y + 1 < grid.heights.height; ++y) {
    for (int x = 1; x + 1 < width; ++x) {
      const std::size_t cell = grid.heights.at({x, y});
      std::int32_t steepest = 0;
      for (int d = 0; d < 8; ++d) {
        const std::size_t other = grid.heights.at({x + kStepX[d], y + kStepY[d]});
        if (!grid.open[other]) continue;
        steepest = std::max(steepest,
                            std::abs(grid.heights.height_mm[cell] - grid.heights.height_mm[other]));
      }
      price[cell] =
          grid.open[cell] ? 1.0F + static_cast<float>(std::min(steepest, 100)) / 67.0F : 0.0F;
    }
  }
  return price;
}

/// Not on a roof, nor in a yard.
bool on_a_street(const DrivableGrid& grid, CellIndex cell) {
  const Field field = *compute_field(grid, cell);
  const auto reached = std::count_if(field.levelled.begin(), field.levelled.end(),
                                     [](std::int32_t cost) { return cost < Field::kUnreached; });
  return reached > static_cast<std::ptrdiff_t>(grid.open.size() / 4);
}

CellIndex open_middle(const DrivableGrid& grid) {
  CellIndex cell{grid.heights.width / 2, grid.heights.height / 2};
  while (!grid.open[grid.heights.at(cell)] || !on_a_street(grid, cell)) ++cell.x;
  return cell;
}

/// Cells that only one of the field and a breadth-first search reaches.
std::size_t reached_differently(const DrivableGrid& grid, const Field& field) {
  const auto stride = static_cast<std::size_t>(grid.ground.stride);
  const std::size_t steps[4] = {1, stride, std::size_t{0} - 1, std::size_t{0} - stride};
  std::vector<bool> reached(field.levelled.size());
  std::vector<std::uint32_t> wave{static_cast<std::uint32_t>(grid.ground_at(field.goal))};
  reached[wave.front()] = true;
  for (std::vector<std::uint32_t> next; !wave.empty(); wave.swap(next), next.clear()) {
    for (const std::uint32_t cell : wave) {
      for (const std::size_t step : steps) {
        const std::size_t other = cell + step;
        if (grid.ground.price[other] == 0 || reached[other]) continue;
        reached[other] = true;
        next.push_back(static_cast<std::uint32_t>(other));
      }
    }
  }
  std::size_t different = 0;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    different += reached[i] != (field.levelled[i] < Field::kUnreached);
  }
  return different;
}

PlannerConfig point_robot() {
  PlannerConfig config;
  config.limits.radius_m = 0.0;
  return config;
}

void measure(Report& report, const std::string& world, int size, std::uint32_t seed) {
  const DrivableGrid grid = make_drivable(planning_world(world, size, seed), point_robot());
  const CellIndex goal = open_middle(grid);
  std::map<std::string, double> times_ms;
  const FieldKernels& fastest = *usable_field_kernels().front();
  std::optional<Field> field;
  for (const FieldKernels* kernels : usable_field_kernels()) {
    times_ms[kernels->name] = 1e3 * least_cpu_s(kRuns, [&] {
                                field.reset();
                                field = unreached_field(grid, goal);
                                TileWave(grid, *field, *kernels).radiate();
                              });
  }
  test::BucketDijkstra peer(prices(grid), size);
  const double peer_ms = 1e3 * least_cpu_s(kRuns, [&] {
                           keep(peer.radiate(static_cast<std::uint32_t>(grid.heights.at(goal))));
                         });
  const double own_ms = times_ms[fastest.name];
  times_ms.erase(fastest.name);
  times_ms["Dijkstra with buckets"] = peer_ms;
  const std::string where = ", " + world + " " + std::to_string(size);
  report.add({"field" + where, own_ms, "ms", Better::lower, {}, times_ms});
  const bool large = size >= 4096 && (world == "open" || world == "terrain");
  report.add({"times NavFn's speed" + where,
              peer_ms / own_ms / kNavfn.at(world),
              "x",
              Better::higher,
              large ? 4.0 : kGoals.at(world),
              {{"Dijkstra with buckets", 1 / kNavfn.at(world)}}});
  report.add({"cells reached differently" + where,
              1.0 * static_cast<double>(reached_differently(grid, *field)),
              "",
              Better::lower,
              0.0,
              {}});
}

int run(int size) {
  Report report("plan_field");
  std::cout << "fastest kernels: " << usable_field_kernels().front()->name << '\n';
  for (const std::string& world : kWorlds) measure(report, world, size, 4711);
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  const int size = argc > 1 ? std::atoi(argv[1]) : 2048;
  if (size < 64 || size > 8192) {
    std::cerr << "bench_plan_field [SIZE]: from 64 to 8192 cells\n";
    return 2;
  }
  return cairn::bench::run(size);
}
