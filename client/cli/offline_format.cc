#include "client/cli/offline_format.h"

#include <cstdio>

#include "client/cli/format.h"

namespace cairn::cli {

namespace {

template <class... Values>
std::string printed(const char* pattern, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

/// [m] Of the ground's outer edges.
struct Edges {
  double west, south, east, north;
};

Edges edges_of(const offline::SiteFacts& facts) {
  const double cell_m = facts.cell_size_mm / 1000.0;
  return {facts.extent->lowest.x * cell_m, facts.extent->lowest.y * cell_m,
          (facts.extent->highest.x + 1.0) * cell_m, (facts.extent->highest.y + 1.0) * cell_m};
}

bool moved(const offline::SiteFacts& facts) {
  return facts.offset != map_files::RasterFrame::Corner{};
}

}  // namespace

nlohmann::json facts_json(const offline::SiteFacts& facts) {
  nlohmann::json levels = nlohmann::json::array();
  for (const auto& level : facts.levels) {
    levels.push_back(
        {{"level", level.level}, {"tiles", level.tiles}, {"known_cells", level.known_cells}});
  }
  nlohmann::json json = {{"site", facts.name},
                         {"cell_size_mm", facts.cell_size_mm},
                         {"map_version", facts.map_version},
                         {"known_cells", facts.known_cells},
                         {"tiles", facts.tiles},
                         {"levels", levels},
                         {"submaps", facts.submaps},
                         {"submaps_merged", facts.submaps_merged},
                         {"bytes_on_disk", facts.bytes_on_disk},
                         {"lowest_m", facts.lowest_mm / 1000.0},
                         {"highest_m", facts.highest_mm / 1000.0},
                         {"offset", {{"x_m", facts.offset.x_m}, {"y_m", facts.offset.y_m}}},
                         {"extent", nullptr}};
  if (facts.extent) {
    const Edges edges = edges_of(facts);
    json["extent"] = {
        {"west_m", edges.west},
        {"south_m", edges.south},
        {"east_m", edges.east},
        {"north_m", edges.north},
        {"columns", std::int64_t{facts.extent->highest.x} - facts.extent->lowest.x + 1},
        {"rows", std::int64_t{facts.extent->highest.y} - facts.extent->lowest.y + 1}};
  }
  return json;
}

std::string facts_text(const offline::SiteFacts& facts) {
  const double cell_m = facts.cell_size_mm / 1000.0;
  std::string text = printed("site %s, cells of %g m, map version %llu\n", facts.name.c_str(),
                             cell_m, static_cast<unsigned long long>(facts.map_version));
  if (facts.extent) {
    const Edges edges = edges_of(facts);
    text += printed("extent   %.2f to %.2f m east, %.2f to %.2f m north (%.0f x %.0f cells)\n",
                    edges.west, edges.east, edges.south, edges.north,
                    (edges.east - edges.west) / cell_m, (edges.north - edges.south) / cell_m);
    text +=
        printed("heights  %.2f to %.2f m\n", facts.lowest_mm / 1000.0, facts.highest_mm / 1000.0);
  }
  text +=
      printed("known    %llu cells, %.0f m2\n", static_cast<unsigned long long>(facts.known_cells),
              static_cast<double>(facts.known_cells) * cell_m * cell_m);
  for (const auto& level : facts.levels) {
    text += printed("level %-2d %llu tiles, %llu cells\n", level.level,
                    static_cast<unsigned long long>(level.tiles),
                    static_cast<unsigned long long>(level.known_cells));
  }
  text += printed("evidence %llu submaps, %llu of them merged\n",
                  static_cast<unsigned long long>(facts.submaps),
                  static_cast<unsigned long long>(facts.submaps_merged));
  text += "on disk  " + bytes_text(static_cast<double>(facts.bytes_on_disk)) + '\n';
  if (moved(facts)) {
    text += printed("origin   at (%.3f, %.3f) of the imported files\n", facts.offset.x_m,
                    facts.offset.y_m);
  }
  return text;
}

nlohmann::json import_json(const offline::ImportReport& report) {
  return {{"founded", report.founded},     {"columns", report.columns},
          {"rows", report.rows},           {"cells", report.cells},
          {"submaps", report.submaps},     {"lone_obstacles", report.lone_obstacles},
          {"too_steep", report.too_steep}, {"west_m", report.west_m},
          {"south_m", report.south_m},     {"site", facts_json(report.site)}};
}

std::string import_text(const offline::ImportReport& report,
                        const offline::ImportRequest& request) {
  std::string text = report.founded ? "founded " + report.site.name + " in " + request.store + '\n'
                                    : std::string();
  text += printed("imported %d x %d cells of %g m, %lld of them known, as %lld submaps\n",
                  report.columns, report.rows, report.site.cell_size_mm / 1000.0,
                  static_cast<long long>(report.cells), static_cast<long long>(report.submaps));
  text += printed("its south-west corner lies at (%.2f, %.2f)", report.west_m, report.south_m);
  text += moved(report.site) ? printed("; the site's origin is (%.3f, %.3f) of the file\n",
                                       report.site.offset.x_m, report.site.offset.y_m)
                             : "\n";
  if (report.lone_obstacles > 0) {
    text += printed("%lld obstacle cells that touch no free ground are left unknown\n",
                    static_cast<long long>(report.lone_obstacles));
  }
  if (report.too_steep > 0) {
    text += printed("%lld cells are left unknown: more than 32 m above or below those around\n",
                    static_cast<long long>(report.too_steep));
  }
  return text;
}

nlohmann::json export_json(const offline::ExportReport& report, const std::string& file) {
  return {{"file", file},
          {"kind", report.kind},
          {"columns", report.columns},
          {"rows", report.rows},
          {"known_cells", report.known_cells}};
}

std::string export_text(const offline::ExportReport& report, const std::string& file) {
  return "wrote " + file + ": " + report.kind +
         printed(", %lld x %lld cells, %llu known\n", static_cast<long long>(report.columns),
                 static_cast<long long>(report.rows),
                 static_cast<unsigned long long>(report.known_cells));
}

nlohmann::json scenarios_json(const offline::ScenarioReport& report) {
  return {{"scenarios", report.scenarios},     {"disagreements", report.disagreements},
          {"reached", report.reached},         {"unreachable", report.unreachable},
          {"invalid", report.invalid},         {"longer", report.longer},
          {"worst_ratio", report.worst_ratio}, {"mean_ratio", report.mean_ratio},
          {"seconds", report.seconds},         {"examples", report.examples}};
}

std::string scenarios_text(const offline::ScenarioReport& report) {
  std::string text = printed(
      "%zu scenarios: %zu reached, %zu without a way, %zu disagreements\n"
      "%zu paths not valid, %zu longer than the optimum; length / optimum %.6f mean, "
      "%.6f worst\n%.1f s\n",
      report.scenarios, report.reached, report.unreachable, report.disagreements, report.invalid,
      report.longer, report.mean_ratio, report.worst_ratio, report.seconds);
  for (const std::string& example : report.examples) text += "  " + example + '\n';
  return text;
}

}  // namespace cairn::cli
