// Repairing a field after a random change of 2 × 2 m against planning anew.
#include <algorithm>
#include <iostream>
#include <random>

#include "core/planner/field_keeper.h"
#include "tests/bench/cpu_time.h"
#include "tests/bench/planning_worlds.h"
#include "tests/bench/report.h"

namespace cairn::bench {
namespace {

constexpr int kSize = 2048;
constexpr int kChanges = 60;
constexpr int kPatch = 16;  ///< [cells] 2 m.

/// Among randomly closed cells nothing wider than one fits.
PlannerConfig vehicle(const std::string& world) {
  PlannerConfig config;
  config.limits.radius_m = world == "random" ? 0.0 : 0.25;
  return config;
}

/// Where a quarter of all cells can be reached from.
CellIndex goal_in(const HeightGrid& heights, const PlannerConfig& config) {
  const DrivableGrid grid = make_drivable(heights, config);
  for (CellIndex cell{kSize / 3, kSize / 3};; ++cell.x) {
    const auto field = compute_field(grid, cell);
    if (!field) continue;
    const auto reached = std::count_if(field->levelled.begin(), field->levelled.end(),
                                       [](std::int32_t cost) { return cost < Field::kUnreached; });
    if (reached > kSize * kSize / 4) return cell;
  }
}

/// A block put down, taken away, or a rise of up to 90 mm.
std::vector<CellChange> random_change(const HeightGrid& heights, std::mt19937& random) {
  const auto place = [&] { return 1 + static_cast<int>(random() % (kSize - kPatch - 2)); };
  const CellIndex low{place(), place()};
  const std::int32_t base_mm = heights.height_mm[heights.at(low)];
  const auto kind = random() % 3;
  const auto rise_mm = static_cast<std::int32_t>(random() % 90);
  std::vector<CellChange> changes;
  for (int i = 0; i < kPatch * kPatch; ++i) {
    const CellIndex cell{low.x + i % kPatch, low.y + i / kPatch};
    const std::int32_t was_mm = heights.height_mm[heights.at(cell)];
    const std::int32_t height_mm = kind == 0   ? base_mm + 1500
                                   : kind == 1 ? base_mm
                                               : was_mm + rise_mm;
    changes.push_back({cell, height_mm, 200});
  }
  return changes;
}

double percentile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

void measure(Report& report, const std::string& world) {
  HeightGrid heights = planning_world(world, kSize, 2024);
  const PlannerConfig config = vehicle(world);
  const CellIndex goal = goal_in(heights, config);
  auto keeper = FieldKeeper::create(make_drivable(std::move(heights), config), config, goal);
  std::mt19937 random(7);
  std::vector<double> repairs_ms;
  for (int i = 0; i < kChanges; ++i) {
    const auto changes = random_change(keeper->grid().heights, random);
    repairs_ms.push_back(1e3 * least_cpu_s(1, [&] { keeper->change(changes); }));
  }
  std::optional<Field> anew;
  const double full_ms = 1e3 * least_cpu_s(5, [&] { anew = *compute_field(keeper->grid(), goal); });
  report.add({"median repair, " + world,
              percentile(repairs_ms, 0.5) / full_ms * 100,
              "% of a plan",
              Better::lower,
              5.0,
              {}});
  report.add({"90th percentile, " + world,
              percentile(repairs_ms, 0.9) / full_ms * 100,
              "% of a plan",
              Better::lower,
              {},
              {}});
  report.add({"median repair, " + world,
              percentile(repairs_ms, 0.5),
              "ms",
              Better::lower,
              {},
              {{"new plan", full_ms}}});
  report.add({"same field, " + world,
              anew->levelled == keeper->field().levelled ? 1.0 : 0.0,
              "",
              Better::higher,
              1.0,
              {}});
}

int run() {
  Report report("repair");
  for (const std::string& world : kWorlds) measure(report, world);
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main() { return cairn::bench::run(); }
