// Every scenario of the Moving AI Lab's maps (data folder, movingai/*/*.map with .map.scen): each
// map is imported into a store, and every scenario planned on it as `cairn plan SITE --scen` does.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "client/offline/import.h"
#include "client/offline/scenarios.h"
#include "tests/bench/report.h"
#include "tests/support/data_folder.h"

namespace {

namespace fs = std::filesystem;
using cairn::offline::ScenarioReport;

std::vector<fs::path> maps_in(const fs::path& folder) {
  std::vector<fs::path> maps;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".map" && fs::exists(entry.path().string() + ".scen")) {
      maps.push_back(entry.path());
    }
  }
  std::sort(maps.begin(), maps.end());
  return maps;
}

cairn::Result<ScenarioReport> run(const fs::path& map, const fs::path& folder) {
  cairn::offline::ImportRequest request;
  request.map_file = map;
  request.store = folder / "bench.cairn";
  request.name = "bench";
  fs::remove(request.store);
  if (const auto imported = cairn::offline::import_map(request); !imported) {
    return imported.error();
  }
  const auto site = cairn::offline::open_site(request.store);
  if (!site) return site.error();
  const auto scenarios = cairn::offline::read_scenarios(map.string() + ".scen");
  if (!scenarios) return scenarios.error();
  cairn::PlannerConfig point;
  point.limits.radius_m = 0.0;
  return cairn::offline::run_scenarios(*site, *scenarios, point);
}

}  // namespace

int main() {
  const fs::path data = cairn::test::data_folder();
  if (data.empty()) {
    std::printf("skipped: no data folder (CAIRN_DATA)\n");
    return 0;
  }
  std::string name = (fs::temp_directory_path() / "cairn_bench_XXXXXX").string();
  const fs::path folder = ::mkdtemp(name.data());
  ScenarioReport all;
  double ratios = 0.0;
  std::printf("%-24s %9s %9s %7s %7s %9s %9s %8s\n", "map", "scenarios", "disagree", "invalid",
              "longer", "mean", "worst", "seconds");
  for (const fs::path& map : maps_in(data / "movingai")) {
    const auto report = run(map, folder);
    if (!report) {
      std::fprintf(stderr, "%s: %s\n", map.c_str(), report.error().message.c_str());
      return 1;
    }
    std::printf("%-24s %9zu %9zu %7zu %7zu %9.6f %9.6f %8.2f\n", map.stem().c_str(),
                report->scenarios, report->disagreements, report->invalid, report->longer,
                report->mean_ratio, report->worst_ratio, report->seconds);
    std::fflush(stdout);
    all.scenarios += report->scenarios;
    all.disagreements += report->disagreements;
    all.invalid += report->invalid;
    all.longer += report->longer;
    all.seconds += report->seconds;
    all.worst_ratio = std::max(all.worst_ratio, report->worst_ratio);
    ratios += report->mean_ratio * static_cast<double>(report->scenarios);
  }
  fs::remove_all(folder);
  using cairn::bench::Better;
  cairn::bench::Report figures("movingai");
  const auto add = [&figures](const char* what, double value, const char* unit, auto goal) {
    figures.add({what, value, unit, Better::lower, goal, {}});
  };
  const auto count = [](std::size_t value) { return static_cast<double>(value); };
  const std::optional<double> no_goal;
  add("scenarios", count(all.scenarios), "", no_goal);
  add("disagreements on reachable", count(all.disagreements), "", 0.0);
  add("paths not valid", count(all.invalid), "", 0.0);
  add("paths longer than the octile optimum", count(all.longer), "", 0.0);
  add("length / optimum, mean", ratios / std::max(count(all.scenarios), 1.0), "", no_goal);
  add("length / optimum, worst", all.worst_ratio, "", no_goal);
  add("time", all.seconds, "s", no_goal);
  figures.print(std::cout);
  return all.good() ? 0 : 1;
}
