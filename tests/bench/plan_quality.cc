// How much more than the best way the planned ways cost, and whether they hold what the MovingAI
// benchmarks list.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <random>

#include "core/planner/field_walk.h"
#include "core/planner/plan.h"
#include "core/planner/tighten.h"
#include "tests/bench/planning_worlds.h"
#include "tests/bench/report.h"
#include "tests/bench/shortest_ways.h"
#include "tests/support/data_folder.h"
#include "tests/support/movingai.h"

namespace cairn::bench {
namespace {

constexpr int kSize = 256;
constexpr int kPairs = 25;
/// Listed lengths have six digits.
constexpr double kListedDigits = 5e-6;
/// Each cell becomes this many in each direction in the reference for terrain.
constexpr int kFiner = 5;

PlannerConfig point_robot() {
  PlannerConfig config;
  config.limits.radius_m = 0.0;
  return config;
}

Eigen::Vector2d middle_m(CellIndex cell) {
  return {(cell.x + 0.5) * 0.125, (cell.y + 0.5) * 0.125};
}

/// The same surface in finer cells: between the cells' middles heights are linear.
HeightGrid finer(const HeightGrid& coarse) {
  HeightGrid fine = empty_grid({0, 0}, {coarse.width * kFiner - 1, coarse.height * kFiner - 1},
                               coarse.cell_size_mm / kFiner)
                        .value();
  for (int y = 0; y < fine.height; ++y) {
    for (int x = 0; x < fine.width; ++x) {
      const double cx = std::clamp((x + 0.5) / kFiner - 0.5, 0.0, coarse.width - 1.001);
      const double cy = std::clamp((y + 0.5) / kFiner - 0.5, 0.0, coarse.height - 1.001);
      const auto at = [&](int dx, int dy) {
        return coarse.height_mm[coarse.at({static_cast<int>(cx) + dx, static_cast<int>(cy) + dy})];
      };
      const double fx = cx - std::floor(cx);
      const double fy = cy - std::floor(cy);
      const double height =
          std::lerp(std::lerp(at(0, 0), at(1, 0), fx), std::lerp(at(0, 1), at(1, 1), fx), fy);
      fine.height_mm[fine.at({x, y})] = static_cast<std::int32_t>(std::lround(height));
      fine.probability[fine.at({x, y})] = 200;
    }
  }
  return fine;
}

/// A grid whose cells are open where those of the coarse one are.
DrivableGrid finer(const DrivableGrid& coarse, const PlannerConfig& config) {
  DrivableGrid fine = make_drivable(finer(coarse.heights), config);
  for (int y = 0; y < fine.heights.height; ++y) {
    for (int x = 0; x < fine.heights.width; ++x) {
      fine.open[fine.heights.at({x, y})] = coarse.open[coarse.heights.at({x / kFiner, y / kFiner})];
    }
  }
  price_ground(fine, config, {0, 0, fine.heights.width - 1, fine.heights.height - 1});
  return fine;
}

struct Pair {
  CellIndex start;
  CellIndex goal;
};

std::vector<Pair> far_pairs(const DrivableGrid& grid, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto open_cell = [&] {
    for (;;) {
      const CellIndex cell{static_cast<int>(random() % kSize), static_cast<int>(random() % kSize)};
      if (grid.open[grid.heights.at(cell)]) return cell;
    }
  };
  std::vector<Pair> pairs;
  while (pairs.size() < kPairs) {
    const Pair pair{open_cell(), open_cell()};
    if (std::hypot(pair.start.x - pair.goal.x, pair.start.y - pair.goal.y) < kSize / 3.0) continue;
    if (plan(grid, {middle_m(pair.start), middle_m(pair.goal)}, point_robot()).status ==
        PathStatus::complete) {
      pairs.push_back(pair);
    }
  }
  return pairs;
}

/// [cost units] The best that is known: exact on flat ground, else the best of a far finer plan,
/// pulled taut on this ground, and of the path in question.
double best_known(const DrivableGrid& grid, const DrivableGrid* fine, const Pair& pair,
                  double own_cost) {
  if (fine == nullptr) return shortest_way(grid, pair.start, pair.goal).value() * kCellUnits;
  PlanRequest request{middle_m(pair.start), middle_m(pair.goal)};
  request.tolerance_m = 0.0;
  const Path path = plan(*fine, request, point_robot());
  const LineCost lines(grid);
  if (path.status != PathStatus::complete) return own_cost;
  return std::min({own_cost, cost_along(lines, path.points_m),
                   cost_along(lines, tighten(lines, path.points_m))});
}

double mean_excess_percent(const std::string& world, std::uint32_t seed) {
  const PlannerConfig config = point_robot();
  const DrivableGrid grid = make_drivable(planning_world(world, kSize, seed), config);
  const LineCost lines(grid);
  std::optional<DrivableGrid> fine;
  if (world == "terrain") fine = finer(grid, config);
  double sum = 0.0;
  for (const Pair& pair : far_pairs(grid, seed)) {
    const Path path = plan(grid, {middle_m(pair.start), middle_m(pair.goal)}, config);
    const double cost = cost_along(lines, path.points_m);
    sum += cost / best_known(grid, fine ? &*fine : nullptr, pair, cost) - 1;
  }
  return sum / kPairs * 100;
}

struct Tally {
  int scenarios = 0;
  int disagreements = 0;  ///< On whether there is a way.
  int invalid = 0;        ///< Paths that touch what is closed, or do not lead to the goal.
  int longer = 0;         ///< Than the listed length.
};

bool valid(const DrivableGrid& grid, const Path& path, const test::Scenario& s) {
  bool open =
      path.points_m.front() == middle_m(s.start) && path.points_m.back() == middle_m(s.goal);
  for (std::size_t i = 1; i < path.points_m.size(); ++i) {
    open = open && line_is_open(grid, path.points_m[i - 1], path.points_m[i]);
  }
  return open;
}

void run_scenarios(const std::filesystem::path& map, Tally& tally) {
  const DrivableGrid grid = make_drivable(test::read_movingai_map(map), point_robot());
  for (const test::Scenario& s : test::read_scenarios(map.string() + ".scen")) {
    const Path path = plan(grid, {middle_m(s.start), middle_m(s.goal)}, point_robot());
    ++tally.scenarios;
    const bool complete = path.status == PathStatus::complete;
    tally.disagreements += complete != s.reachable();
    if (!complete) continue;
    tally.invalid += !valid(grid, path, s);
    tally.longer += path.length_m / 0.125 > s.length * (1 + kListedDigits);
  }
}

void add_movingai(Report& report) {
  Tally tally;
  for (const auto& file :
       std::filesystem::recursive_directory_iterator(test::data_folder() / "movingai")) {
    if (file.path().extension() == ".map") run_scenarios(file.path(), tally);
  }
  report.add({"MovingAI scenarios", 1.0 * tally.scenarios, "", Better::higher, {}, {}});
  report.add({"disagreements on reachable", 1.0 * tally.disagreements, "", Better::lower, 0.0, {}});
  report.add({"paths not valid", 1.0 * tally.invalid, "", Better::lower, 0.0, {}});
  report.add({"paths longer than listed", 1.0 * tally.longer, "", Better::lower, 0.0, {}});
}

int run() {
  const std::map<std::string, double> goals = {
      {"open", 0.1}, {"random", 1.9}, {"city", 0.65}, {"maze", 1.9}, {"terrain", 0.1}};
  const std::map<std::string, double> navfn = {
      {"open", 0.30}, {"city", 0.73}, {"maze", 2.08}, {"terrain", 0.44}};
  Report report("plan_quality");
  for (const std::string& world : kWorlds) {
    std::map<std::string, double> peers;
    if (navfn.count(world) != 0) peers["NavFn, published"] = navfn.at(world);
    report.add({"cost above the best way, " + world, mean_excess_percent(world, 77), "%",
                Better::lower, goals.at(world), peers});
  }
  if (!test::data_folder().empty()) add_movingai(report);
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main() { return cairn::bench::run(); }
