#include "client/cli/format.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/common/angle.h"

namespace cairn::cli {

namespace {

template <class... Values>
std::string printed(const char* pattern, Values... values) {
  std::string text(256, '\0');
  const int size = std::snprintf(text.data(), text.size(), pattern, values...);
  text.resize(std::min(text.size() - 1, static_cast<std::size_t>(std::max(size, 0))));
  return text;
}

std::string count_text(std::uint64_t count) {
  auto text = std::to_string(count);
  for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) {
    text.insert(static_cast<std::size_t>(at), 1, ',');
  }
  return text;
}

std::string link_state(const api::LinkJson& link) {
  return link.connected ? "up" : std::string("LOST for ").append(age_text(link.silence_s));
}

const api::RobotJson* find_robot(const api::StatusReply& status, const std::string& id) {
  const auto found = std::ranges::find(status.robots, id, &api::RobotJson::id);
  return found == status.robots.end() ? nullptr : &*found;
}

std::string sites_text(const api::StatusReply& status) {
  if (status.sites.empty()) return "no sites yet: found one with `cairn found NAME`\n";
  std::vector<std::vector<std::string>> rows = {
      {"SITE", "CELL", "MAP VERSION", "KNOWN", "TILES", "MEMORY", "SUBMAPS MERGED", "COMMITS"}};
  for (const auto& site : status.sites) {
    const double cell_m = site.cell_size_mm / 1000.0;
    rows.push_back({site.name, printed("%g m", cell_m), std::to_string(site.map_version),
                    printed("%.0f m2", static_cast<double>(site.known_cells) * cell_m * cell_m),
                    count_text(site.tiles), bytes_text(static_cast<double>(site.memory_bytes)),
                    count_text(site.submaps_merged) + " of " + count_text(site.submaps),
                    count_text(site.commits)});
  }
  return table_text(rows);
}

std::string sureness_text(const api::RobotJson& robot) {
  if (robot.localization == "lost") return " LOST";
  return printed(" +-%.2f m", robot.sigma_m) + (robot.localization == "unsure" ? " unsure" : "");
}

std::string robots_text(const api::StatusReply& status) {
  if (status.robots.empty()) return "no robots: start cairn-agent on one\n";
  std::vector<std::vector<std::string>> rows = {
      {"ROBOT", "SITE", "AT", "HEADING", "SEEN", "SPEED", "DOES", "COMMAND", "LINK"}};
  for (const auto& robot : status.robots) {
    std::string command = "-";
    if (robot.command) {
      command = robot.command->kind + " " + robot.command->state;
      if (!robot.command->why.empty()) command += " (" + robot.command->why + ")";
      if (robot.command->heading_rad) {
        command += ", heading " + heading_text(*robot.command->heading_rad);
      }
      if (robot.command->eta_s) command += ", about " + age_text(*robot.command->eta_s) + " to go";
    }
    const bool more = robot.task && (robot.task->legs_all != 1 || robot.task->waiting > 0);
    if (more) command += "; " + task_text(*robot.task);
    rows.push_back({robot.id, robot.site, place_text(robot.x_m, robot.y_m) + sureness_text(robot),
                    heading_text(robot.yaw_rad), age_text(robot.pose_age_s) + " ago",
                    printed("%.2f m/s", robot.speed_m_s), robot.drive, command,
                    link_state(robot.link)});
  }
  return table_text(rows);
}

double rate(std::uint64_t before, std::uint64_t after, double seconds) {
  if (seconds <= 0.0 || after < before) return 0.0;
  return static_cast<double>(after - before) / seconds;
}

}  // namespace

std::string age_text(double seconds) {
  if (!(seconds >= 0.0)) return "?";
  if (seconds < 9.95) return printed("%.1f s", seconds);
  if (seconds < 120.0) return printed("%.0f s", seconds);
  const auto whole = static_cast<long long>(std::min(seconds, 1e12));
  if (seconds < 7200.0) return printed("%lld min %02lld s", whole / 60, whole % 60);
  if (seconds < 172'800.0) return printed("%lld h %02lld min", whole / 3600, whole / 60 % 60);
  return printed("%lld d %lld h", whole / 86'400, whole / 3600 % 24);
}

std::string bytes_text(double bytes) {
  if (bytes < 999.5) return printed("%.0f B", bytes);
  constexpr const char* kUnits[] = {"kB", "MB", "GB", "TB", "PB"};
  std::size_t unit = 0;
  bytes /= 1000.0;
  while (bytes >= 999.5 && unit + 1 < std::size(kUnits)) {
    bytes /= 1000.0;
    ++unit;
  }
  return printed(bytes < 9.995   ? "%.2f %s"
                 : bytes < 99.95 ? "%.1f %s"
                                 : "%.0f %s",
                 bytes, kUnits[unit]);
}

std::string place_text(double x_m, double y_m) { return printed("(%.2f, %.2f)", x_m, y_m); }

std::string heading_text(double yaw_rad) { return printed("%.0f deg", degrees(yaw_rad)); }

std::string table_text(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i] + std::string(widths[i] - row[i].size() + 2, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

std::string status_text(const api::StatusReply& status) {
  return "cairn-server " + status.version + ", up " + age_text(status.uptime_s) + "\n\n" +
         sites_text(status) + '\n' + robots_text(status);
}

std::string task_text(const api::TaskJson& task) {
  std::string text = task.kind;
  if (task.state != "active") text += " " + task.state;
  text += ", " + count_text(task.legs);
  if (task.legs_all > 0) text += " of " + count_text(task.legs_all);
  text += " places";
  if (task.rounds > 0) text += " in round " + count_text(task.rounds + 1);
  if (task.eta_s) text += ", about " + age_text(*task.eta_s) + " to go";
  if (task.waiting > 0) text += ", " + count_text(task.waiting) + " tasks behind it";
  return text;
}

std::string robot_line(const api::RobotJson& robot) {
  std::string line = robot.id + "  " + place_text(robot.x_m, robot.y_m) +
                     printed(" %4.0f deg  %.2f m/s", degrees(robot.yaw_rad), robot.speed_m_s) +
                     "  " + robot.drive;
  if (robot.drive == "driving" && robot.command) {
    line += printed(", %.1f m to go", robot.command->to_go_m);
    if (robot.command->heading_rad)
      line += ", then to " + heading_text(*robot.command->heading_rad);
  }
  return line + "  seen " + age_text(robot.pose_age_s) + " ago  link " + link_state(robot.link) +
         "  up " + bytes_text(static_cast<double>(robot.link.bytes_up)) + " down " +
         bytes_text(static_cast<double>(robot.link.bytes_down));
}

namespace {

/// What each direction of a link carried, and what it was for.
std::vector<std::string> traffic_row(const api::RobotJson& robot, const api::LinkJson& from,
                                     bool up, double seconds) {
  const api::LinkJson& link = robot.link;
  const api::TrafficJson& now = up ? link.up : link.down;
  const api::TrafficJson& then = up ? from.up : from.down;
  const auto kbit = [&](std::uint64_t a, std::uint64_t b) {
    return printed("%.2f", rate(a, b, seconds) * 8e-3);
  };
  const double loss = up ? link.loss_up : link.loss_down;
  return {robot.id,
          up ? "up" : "down",
          bytes_text(static_cast<double>(up ? link.bytes_up : link.bytes_down)),
          kbit(up ? from.bytes_up : from.bytes_down, up ? link.bytes_up : link.bytes_down),
          kbit(then.control_bytes, now.control_bytes),
          kbit(then.pose_bytes, now.pose_bytes),
          kbit(then.map_bytes, now.map_bytes),
          up ? "-" : printed("%.1f", link.budget_down_bit_s * 1e-3),
          printed("%.0f %%", loss * 100.0),
          up ? "-" : printed("%.0f ms", link.queue_s * 1e3),
          up ? "-" : bytes_text(static_cast<double>(link.unacknowledged_bytes))};
}

/// How long until the server holds everything, if the robot adds nothing: by how fast its backlog
/// went down meanwhile.
std::string synchronised_text(const api::LinkJson& from, const api::LinkJson& link,
                              double seconds) {
  if (link.backlog_blocks == 0) return "now";
  const double gone = static_cast<double>(from.backlog_blocks) - link.backlog_blocks;
  if (seconds <= 0.0 || gone <= 0.0) return "-";
  return "in " + age_text(link.backlog_blocks * seconds / gone);
}

/// What waits on the robot, and what had to go there.
std::string spool_text(const api::LinkJson& link) {
  if (!link.spool) return "-";
  const api::SpoolJson& spool = *link.spool;
  std::string text =
      count_text(spool.submaps) + " submaps, " + bytes_text(static_cast<double>(spool.bytes));
  if (spool.thinned > 0) text += ", " + count_text(spool.thinned) + " THINNED";
  if (spool.dropped > 0) text += ", " + count_text(spool.dropped) + " DROPPED";
  if (spool.state != "ok") text += ", DISK FAILED";
  return text;
}

}  // namespace

std::string link_text(const api::StatusReply& before, const api::StatusReply& after) {
  if (after.robots.empty()) return robots_text(after);
  const double seconds = after.uptime_s - before.uptime_s;
  std::vector<std::vector<std::string>> states = {{"ROBOT", "LINK", "ROUND TRIP", "SILENCE", "LOST",
                                                   "MALFORMED", "BACKLOG", "SYNCHRONISED",
                                                   "SPOOL"}};
  std::vector<std::vector<std::string>> traffic = {{"ROBOT", "WAY", "BYTES", "KBIT/S", "CONTROL",
                                                    "POSE", "MAP", "BUDGET", "LOSS", "QUEUE",
                                                    "UNACKED"}};
  for (const auto& robot : after.robots) {
    const auto& link = robot.link;
    const auto* earlier = find_robot(before, robot.id);
    const auto& from = earlier != nullptr ? earlier->link : link;
    states.push_back({robot.id, link.connected ? "up" : "LOST",
                      printed("%.0f ms", link.round_trip_s * 1e3), age_text(link.silence_s),
                      count_text(link.frames_lost) + " frames", count_text(link.frames_malformed),
                      count_text(link.backlog_blocks) + " blocks",
                      synchronised_text(from, link, seconds), spool_text(link)});
    for (const bool up : {true, false}) traffic.push_back(traffic_row(robot, from, up, seconds));
  }
  return table_text(states) + '\n' + table_text(traffic);
}

std::string command_text(const api::CommandReply& reply, const std::string& what) {
  if (reply.status == "queued") {
    const std::string why = reply.why.empty() ? "" : ": " + reply.why;
    return what + " queued for " + reply.robot + " (task " + std::to_string(reply.task) + ")" +
           why + '\n';
  }
  std::string text =
      what + " sent to " + reply.robot + " (command " + std::to_string(reply.command) + ")";
  if (!reply.path.empty()) text += printed(": %.1f m of way", reply.length_m);
  if (reply.status == "partial") text += ", only part of the way: " + reply.why;
  return text + '\n';
}

std::string plan_text(const api::PlanReply& reply) {
  if (reply.status == "none") return "no way: " + reply.why + '\n';
  std::string text =
      printed(
          "%s: %.1f m of way, effort of %.1f m level driving, planned in %.0f ms on map version ",
          reply.status.c_str(), reply.length_m, reply.cost_m, reply.seconds * 1e3) +
      std::to_string(reply.map_version) + '\n';
  if (!reply.why.empty()) text += reply.why + '\n';
  for (const auto& point : reply.path) text += "  " + place_text(point.x_m, point.y_m) + '\n';
  return text;
}

}  // namespace cairn::cli
