#include "client/offline/scenarios.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <thread>

#include "client/map_files/words.h"
#include "core/planner/plan.h"

namespace cairn::offline {

namespace {

/// Fields of a line between tabs (names of maps may hold blanks) or, without tabs, blanks.
std::vector<std::string> fields_of(const std::string& line) {
  const char* separators = line.find('\t') != std::string::npos ? "\t" : " ";
  std::vector<std::string> fields;
  for (std::size_t at = line.find_first_not_of(separators); at != std::string::npos;) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    fields.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(separators, end);
  }
  while (!fields.empty() && fields.back().find_first_not_of(' ') == std::string::npos) {
    fields.pop_back();
  }
  return fields;
}

Result<Scenario> scenario_in(const std::vector<std::string>& fields,
                             const map_files::Words& words) {
  if (fields.size() != 9) {
    return words.bad("has " + std::to_string(fields.size()) +
                     " fields, expected 9: bucket, map, width, height, start x, y, goal x, y, "
                     "length");
  }
  std::array<std::int64_t, 6> cells{};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto value = map_files::whole_number_in(fields[i + 2]);
    if (!value || *value < 0 || *value > std::numeric_limits<std::int32_t>::max()) {
      return words.bad("\"" + fields[i + 2] + "\" is no cell");
    }
    cells[i] = *value;
  }
  const auto optimum = map_files::number_in(fields[8]);
  if (!optimum || !(*optimum >= 0.0) || !std::isfinite(*optimum)) {
    return words.bad("\"" + fields[8] + "\" is no length");
  }
  const auto [columns, rows, start_x, start_y, goal_x, goal_y] = cells;
  if (std::max(start_x, goal_x) >= columns || std::max(start_y, goal_y) >= rows) {
    return words.bad("a cell lies outside the map");
  }
  const auto whole = [](std::int64_t value) { return static_cast<int>(value); };
  return Scenario{whole(columns), whole(rows),   whole(start_x), whole(start_y),
                  whole(goal_x),  whole(goal_y), *optimum,       words.line()};
}

/// What became of one scenario.
struct Outcome {
  bool reached = false;
  bool expected = false;
  bool valid = true;
  double length = 0.0;  ///< [cells]
};

/// Plans scenarios on one grid.
class Course {
 public:
  Course(const DrivableGrid& grid, const CellExtent& extent, const PlannerConfig& config)
      : grid_(grid), extent_(extent), config_(config) {}

  [[nodiscard]] Outcome run(const Scenario& scenario) const {
    const CellIndex start = cell(scenario.start_x, scenario.start_y);
    const CellIndex goal = cell(scenario.goal_x, scenario.goal_y);
    Outcome outcome;
    outcome.expected = scenario.optimum > 0.0 || start == goal;
    if (!open(start) || !open(goal)) {
      outcome.expected = outcome.expected && start != goal;  // Nobody stands there to begin with.
      return outcome;
    }
    PlanRequest request;
    request.start_m = middle_m(start);
    request.goal_m = middle_m(goal);
    const Path path = plan(grid_, request, config_);
    outcome.reached = path.status == PathStatus::complete;
    if (outcome.reached) judge(path, request, outcome);
    return outcome;
  }

 private:
  [[nodiscard]] CellIndex cell(int x, int y) const {
    return {extent_.lowest.x + x, extent_.highest.y - y};
  }
  [[nodiscard]] Eigen::Vector2d middle_m(CellIndex cell) const {
    const double cell_m = grid_.heights.cell_size_mm / 1000.0;
    return {(cell.x + 0.5) * cell_m, (cell.y + 0.5) * cell_m};
  }
  [[nodiscard]] bool open(CellIndex cell) const {
    return grid_.heights.contains(cell) && grid_.open[grid_.heights.at(cell)] != 0;
  }

  /// Measures the points themselves, whatever the planner says of them.
  void judge(const Path& path, const PlanRequest& request, Outcome& outcome) const {
    const auto& points = path.points_m;
    outcome.valid =
        !points.empty() && points.front() == request.start_m && points.back() == request.goal_m;
    double length_m = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      outcome.valid = outcome.valid && line_is_open(grid_, points[i - 1], points[i]);
      length_m += (points[i] - points[i - 1]).norm();
    }
    outcome.length = length_m * 1000.0 / grid_.heights.cell_size_mm;
  }

  const DrivableGrid& grid_;
  CellExtent extent_;
  PlannerConfig config_;
};

/// Whether a path is longer than an optimum that the file tells with six digits.
bool longer_than(double length, double optimum) { return length > optimum * (1.0 + 1e-5) + 1e-3; }

void add_example(ScenarioReport& report, const Scenario& scenario, const Outcome& outcome,
                 const char* what) {
  if (report.examples.size() >= ScenarioReport::kMaxExamples) return;
  char text[160];
  std::snprintf(text, sizeof text, "line %lld, (%d, %d) to (%d, %d): %s; length %.5f, listed %.5f",
                static_cast<long long>(scenario.line), scenario.start_x, scenario.start_y,
                scenario.goal_x, scenario.goal_y, what, outcome.length, scenario.optimum);
  report.examples.emplace_back(text);
}

void count(ScenarioReport& report, const Scenario& scenario, const Outcome& outcome, double& ratios,
           std::size_t& compared) {
  ++(outcome.reached ? report.reached : report.unreachable);
  if (outcome.reached != outcome.expected) {
    ++report.disagreements;
    add_example(report, scenario, outcome, outcome.reached ? "reached" : "not reached");
  }
  if (!outcome.reached) return;
  if (!outcome.valid) {
    ++report.invalid;
    add_example(report, scenario, outcome, "the path is not valid");
  }
  if (!outcome.expected) return;
  if (longer_than(outcome.length, scenario.optimum)) {
    ++report.longer;
    add_example(report, scenario, outcome, "longer than the optimum");
  }
  if (scenario.optimum <= 0.0) return;
  ratios += outcome.length / scenario.optimum;
  ++compared;
  report.worst_ratio = std::max(report.worst_ratio, outcome.length / scenario.optimum);
}

Status check_size(const std::vector<Scenario>& scenarios, const CellExtent& extent) {
  const std::int64_t columns = std::int64_t{extent.highest.x} - extent.lowest.x + 1;
  const std::int64_t rows = std::int64_t{extent.highest.y} - extent.lowest.y + 1;
  for (const Scenario& scenario : scenarios) {
    if (scenario.map_columns == columns && scenario.map_rows == rows) continue;
    return Error{ErrorCode::invalid_argument,
                 "line " + std::to_string(scenario.line) + " is for a map of " +
                     std::to_string(scenario.map_columns) + " x " +
                     std::to_string(scenario.map_rows) + " cells, the site's ground has " +
                     std::to_string(columns) + " x " + std::to_string(rows) +
                     ": import the map that the scenarios name, alone"};
  }
  return {};
}

}  // namespace

Result<std::vector<Scenario>> read_scenarios(const std::string& path) {
  auto words = map_files::Words::open(path);
  if (!words) return words.error();
  auto head = words->rest_of_line();
  if (!head) return head.error();
  const auto version = fields_of(*head);
  const bool known =
      version.size() == 2 && version[0] == "version" && map_files::number_in(version[1]) == 1.0;
  if (!known) return words->bad("is no scenario file of version 1");
  std::vector<Scenario> scenarios;
  while (!words->at_end()) {
    auto line = words->rest_of_line();
    if (!line) return line.error();
    const auto fields = fields_of(*line);
    if (fields.empty()) continue;
    if (scenarios.size() == kMaxScenarios) return words->bad("more than a million scenarios");
    const auto scenario = scenario_in(fields, *words);
    if (!scenario) return scenario.error();
    scenarios.push_back(*scenario);
  }
  return scenarios;
}

Result<ScenarioReport> run_scenarios(const OpenSite& site, const std::vector<Scenario>& scenarios,
                                     const PlannerConfig& config) {
  const auto began = std::chrono::steady_clock::now();
  const auto extent = extent_of(site);
  if (!extent) return Error{ErrorCode::unavailable, site.file + " has no known ground"};
  if (auto sized = check_size(scenarios, *extent); !sized) return sized.error();
  auto heights = ground_in(*site.world->snapshot(), *extent);
  if (!heights) return heights.error();
  const DrivableGrid grid = make_drivable(*std::move(heights), config);
  const Course course(grid, *extent, config);

  std::vector<Outcome> outcomes(scenarios.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < scenarios.size(); i = next++) {
      outcomes[i] = course.run(scenarios[i]);
    }
  };
  std::thread helper(work);
  work();
  helper.join();

  ScenarioReport report;
  report.scenarios = scenarios.size();
  double ratios = 0.0;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    count(report, scenarios[i], outcomes[i], ratios, compared);
  }
  if (compared > 0) report.mean_ratio = ratios / static_cast<double>(compared);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return report;
}

}  // namespace cairn::offline
