#include "server/api/metrics.h"

#include <functional>
#include <sstream>
#include <string_view>

namespace cairn::server {

namespace {

using api::RobotJson;
using api::SiteJson;

/// Label values: \, " and line ends are escaped.
std::string label_value(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\\' || c == '"') out += '\\';
    if (c == '\n') {
      out += "\\n";
    } else {
      out += c;
    }
  }
  return out + '"';
}

class Page {
 public:
  Page() { out_.precision(12); }

  void family(const std::string& name, const std::string& type, const std::string& help) {
    out_ << "# HELP " << name << ' ' << help << "\n# TYPE " << name << ' ' << type << '\n';
  }
  void sample(const std::string& name, const std::string& labels, double value) {
    out_ << name << labels << ' ' << value << '\n';
  }
  /// One sample for the server as a whole.
  void single(const std::string& name, const std::string& type, const std::string& help,
              double value) {
    family(name, type, help);
    sample(name, "", value);
  }
  [[nodiscard]] std::string text() const { return out_.str(); }

 private:
  std::ostringstream out_;
};

template <class T>
struct Series {
  const char* name;
  const char* type;
  const char* help;
  std::function<double(const T&)> value;
};

template <class T>
double number(T value) {
  return static_cast<double>(value);
}

const std::vector<Series<SiteJson>>& site_series() {
  static const std::vector<Series<SiteJson>> series = {
      {"cairn_site_known_cells", "gauge", "Cells of the long-term map that are known.",
       [](const SiteJson& s) { return number(s.known_cells); }},
      {"cairn_site_tiles", "gauge", "Tiles of the long-term map.",
       [](const SiteJson& s) { return number(s.tiles); }},
      {"cairn_site_memory_bytes", "gauge", "Memory held for the map.",
       [](const SiteJson& s) { return number(s.memory_bytes); }},
      {"cairn_site_map_version", "gauge", "Version of the long-term map.",
       [](const SiteJson& s) { return number(s.map_version); }},
      {"cairn_site_submaps", "gauge", "Evidence submaps held.",
       [](const SiteJson& s) { return number(s.submaps); }},
      {"cairn_site_submaps_merged", "gauge", "Submaps folded into the long-term map.",
       [](const SiteJson& s) { return number(s.submaps_merged); }},
      {"cairn_site_commits_total", "counter", "Store transactions since the server started.",
       [](const SiteJson& s) { return number(s.commits); }},
  };
  return series;
}

const std::vector<Series<RobotJson>>& robot_series() {
  static const std::vector<Series<RobotJson>> series = {
      {"cairn_robot_connected", "gauge", "1 while the robot's link is up.",
       [](const RobotJson& r) { return r.link.connected ? 1.0 : 0.0; }},
      {"cairn_robot_silence_seconds", "gauge", "Since the robot's last frame.",
       [](const RobotJson& r) { return r.link.silence_s; }},
      {"cairn_robot_pose_age_seconds", "gauge", "Age of the robot's pose.",
       [](const RobotJson& r) { return r.pose_age_s; }},
      {"cairn_robot_round_trip_seconds", "gauge", "Estimated round trip of the link.",
       [](const RobotJson& r) { return r.link.round_trip_s; }},
      {"cairn_robot_bytes_up_total", "counter", "IP bytes received from the robot.",
       [](const RobotJson& r) { return number(r.link.bytes_up); }},
      {"cairn_robot_bytes_down_total", "counter", "IP bytes sent to the robot.",
       [](const RobotJson& r) { return number(r.link.bytes_down); }},
      {"cairn_robot_frames_lost_total", "counter", "Frames of the robot that never came.",
       [](const RobotJson& r) { return number(r.link.frames_lost); }},
      {"cairn_robot_frames_malformed_total", "counter", "Frames of the robot that were refused.",
       [](const RobotJson& r) { return number(r.link.frames_malformed); }},
      {"cairn_robot_backlog_blocks", "gauge", "Evidence the robot has and the server lacks.",
       [](const RobotJson& r) { return number(r.link.backlog_blocks); }},
      {"cairn_robot_spool_bytes", "gauge", "Evidence on the robot's disk; 0 without a spool.",
       [](const RobotJson& r) { return r.link.spool ? number(r.link.spool->bytes) : 0.0; }},
      {"cairn_robot_spool_failed", "gauge", "1: the robot's disk takes no more evidence.",
       [](const RobotJson& r) { return r.link.spool && r.link.spool->state != "ok" ? 1.0 : 0.0; }},
      {"cairn_robot_spool_dropped", "gauge",
       "Submaps of the robot's present run that went before the server had them.",
       [](const RobotJson& r) { return r.link.spool ? number(r.link.spool->dropped) : 0.0; }},
  };
  return series;
}

}  // namespace

std::string metrics_text(const api::StatusReply& status, const ApiCounts& counts) {
  Page page;
  page.family("cairn_info", "gauge", "The running version.");
  page.sample("cairn_info", "{version=" + label_value(status.version) + "}", 1.0);
  page.single("cairn_uptime_seconds", "gauge", "Since the server started.", status.uptime_s);
  page.single("cairn_api_connections", "gauge", "Open API connections.",
              number(counts.connections));
  page.single("cairn_api_connections_refused_total", "counter", "API connections beyond the bound.",
              number(counts.refused));
  for (const auto& series : site_series()) {
    page.family(series.name, series.type, series.help);
    for (const auto& site : status.sites) {
      page.sample(series.name, "{site=" + label_value(site.name) + "}", series.value(site));
    }
  }
  for (const auto& series : robot_series()) {
    page.family(series.name, series.type, series.help);
    for (const auto& robot : status.robots) {
      page.sample(series.name,
                  "{robot=" + label_value(robot.id) + ",site=" + label_value(robot.site) + "}",
                  series.value(robot));
    }
  }
  return page.text();
}

}  // namespace cairn::server
