#pragma once

#include <string>
#include <vector>

#include "client/offline/site.h"
#include "core/planner/trulla.h"

namespace cairn::offline {

/// One problem of a Moving AI scenario file. Cells count from the north-west corner.
struct Scenario {
  int map_columns = 0;
  int map_rows = 0;
  int start_x = 0;
  int start_y = 0;
  int goal_x = 0;
  int goal_y = 0;
  double optimum = 0.0;  ///< [cells] Octile length; 0 between different cells: unreachable.
  std::int64_t line = 0;
};

/// [scenarios] In one file.
inline constexpr std::size_t kMaxScenarios = 1'000'000;

/// Reads a .scen file, version 1 (movingai.com/benchmarks/formats.html). corrupt names the line:
/// another version, a wrong count of fields, a word that is no number, a cell outside the map.
[[nodiscard]] Result<std::vector<Scenario>> read_scenarios(const std::string& path);

/// How the planner did on a file of scenarios.
struct ScenarioReport {
  std::size_t scenarios = 0;
  std::size_t disagreements = 0;  ///< On whether there is a way.
  std::size_t reached = 0;
  std::size_t unreachable = 0;
  std::size_t invalid = 0;   ///< Paths that leave the ground, cut a corner or end elsewhere.
  std::size_t longer = 0;    ///< Paths longer than the optimum by more than it is rounded.
  double worst_ratio = 0.0;  ///< [1] Of path length to optimum; 0 when none was reached.
  double mean_ratio = 0.0;
  double seconds = 0.0;
  std::vector<std::string> examples;  ///< Of what went wrong, at most kMaxExamples.
  static constexpr std::size_t kMaxExamples = 10;
  [[nodiscard]] bool good() const { return disagreements == 0 && invalid == 0 && longer == 0; }
};

/// Plans every scenario on the site's ground by the rules of the benchmark: eight neighbours, no
/// corner of an obstacle is cut, the vehicle is a point unless `config` says otherwise, and nobody
/// begins or ends on an obstacle. On two threads; memory: as plan() for each.
/// invalid_argument when the scenarios are for a map of another size than the site's.
[[nodiscard]] Result<ScenarioReport> run_scenarios(const OpenSite& site,
                                                   const std::vector<Scenario>& scenarios,
                                                   const PlannerConfig& config);

}  // namespace cairn::offline
