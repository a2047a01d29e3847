#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "proto/json/messages.h"

/// Facts as lines for people.
namespace cairn::cli {

/// "0.4 s", "12 s", "3 min 05 s", "2 h 10 min", "4 d 3 h".
[[nodiscard]] std::string age_text(double seconds);
/// "812 B", "3.4 kB", "1.25 MB" (1 kB = 1000 B).
[[nodiscard]] std::string bytes_text(double bytes);
/// "(12.50, -3.00)"
[[nodiscard]] std::string place_text(double x_m, double y_m);

/// "90 deg"
[[nodiscard]] std::string heading_text(double yaw_rad);

/// Columns aligned, two spaces between, no trailing blanks; the first row is the head.
[[nodiscard]] std::string table_text(const std::vector<std::vector<std::string>>& rows);

[[nodiscard]] std::string status_text(const api::StatusReply& status);
/// "goto, 2 of 5 places", "explore done, 7 places", …
[[nodiscard]] std::string task_text(const api::TaskJson& task);
/// One line of `watch` for a robot.
[[nodiscard]] std::string robot_line(const api::RobotJson& robot);
/// `before` and `after` are two looks at the same server; rates come from what lies between.
[[nodiscard]] std::string link_text(const api::StatusReply& before, const api::StatusReply& after);
[[nodiscard]] std::string command_text(const api::CommandReply& reply, const std::string& what);
[[nodiscard]] std::string plan_text(const api::PlanReply& reply);

}  // namespace cairn::cli
