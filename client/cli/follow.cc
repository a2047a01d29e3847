#include "client/cli/follow.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "client/cli/format.h"
#include "client/cli/options.h"

namespace cairn::cli {

namespace {

std::string with_why(std::string text, const std::string& why) {
  return why.empty() ? text : std::move(text) + ": " + why;
}

/// What came into the count since `start`; the count begins anew when the server restarts.
double since(std::uint64_t start, std::uint64_t now) {
  return static_cast<double>(now >= start ? now - start : now);
}

const api::RobotJson* find_robot(const api::StatusReply& status, const std::string& id) {
  const auto found = std::ranges::find(status.robots, id, &api::RobotJson::id);
  return found == status.robots.end() ? nullptr : &*found;
}

}  // namespace

Follow::Follow(const api::StatusReply& before, std::string robot, std::uint64_t command)
    : robot_(std::move(robot)), command_(command), started_s_(before.uptime_s) {
  if (const auto* found = find_robot(before, robot_)) {
    bytes_up_ = found->link.bytes_up;
    bytes_down_ = found->link.bytes_down;
  }
}

Follow::Step Follow::step(const api::StatusReply& status) {
  const auto* robot = find_robot(status, robot_);
  if (robot == nullptr) {
    return {robot_ + " is no longer known to the server: see `cairn status`", kExitFailed};
  }
  if (!robot->command || robot->command->id < command_) return {progress(*robot), std::nullopt};
  if (robot->command->id > command_) {
    return {"superseded by command " + std::to_string(robot->command->id), kExitFailed};
  }
  if (auto end = ended(*robot->command)) {
    if (end->exit == kExitOk) {
      end->line += " at " + place_text(robot->x_m, robot->y_m);
      if (robot->command->heading_rad) end->line += ", heading " + heading_text(robot->yaw_rad);
      end->line += " after " + age_text(status.uptime_s - started_s_) + ", link up " +
                   bytes_text(since(bytes_up_, robot->link.bytes_up)) + " down " +
                   bytes_text(since(bytes_down_, robot->link.bytes_down));
    }
    return *end;
  }
  if (blocked_for_good(*robot->command, status.uptime_s)) {
    return {with_why("blocked", robot->command->why), kExitFailed};
  }
  return {progress(*robot), std::nullopt};
}

std::optional<Follow::Step> Follow::ended(const api::CommandJson& command) const {
  if (command.state == "arrived") return Step{robot_ + " arrived", kExitOk};
  for (const auto* state : {"refused", "superseded", "stopped", "expired"}) {
    if (command.state == state) return Step{with_why(command.state, command.why), kExitFailed};
  }
  return std::nullopt;
}

bool Follow::blocked_for_good(const api::CommandJson& command, double now_s) {
  if (command.state != "blocked") {
    blocked_since_s_.reset();
    return false;
  }
  if (!blocked_since_s_ || command.revision != blocked_revision_) {
    blocked_since_s_ = now_s;
    blocked_revision_ = command.revision;
  }
  return now_s - *blocked_since_s_ >= kBlockedForGoodS;
}

std::string Follow::progress(const api::RobotJson& robot) const {
  std::string state = "waiting for the robot's answer";
  if (robot.command && robot.command->id == command_ && robot.command->state != "sent") {
    char to_go[32];
    std::snprintf(to_go, sizeof to_go, "%.1f m to go", robot.command->to_go_m);
    state = robot.command->state == "blocked" ? with_why("blocked", robot.command->why) : to_go;
    if (robot.command->heading_rad) {
      state += ", heading " + heading_text(robot.yaw_rad) + " of " +
               heading_text(*robot.command->heading_rad);
    }
  }
  char speed[32];
  std::snprintf(speed, sizeof speed, "%.2f m/s", robot.speed_m_s);
  std::string line = robot_ + " at " + place_text(robot.x_m, robot.y_m) + "  " + state + "  " +
                     speed + "  pose " + age_text(robot.pose_age_s) + " old  link up " +
                     bytes_text(since(bytes_up_, robot.link.bytes_up)) + " down " +
                     bytes_text(since(bytes_down_, robot.link.bytes_down));
  if (!robot.link.connected) line += "  LINK LOST for " + age_text(robot.link.silence_s);
  return line;
}

Follow::Step FollowTask::step(const api::StatusReply& status) const {
  const auto* robot = find_robot(status, robot_);
  if (robot == nullptr) {
    return {robot_ + " is no longer known to the server: see `cairn status`", kExitFailed};
  }
  const auto& task = robot->task;
  if (!task || task->id < task_) return {robot_ + " does something else first", std::nullopt};
  if (task->id > task_) {
    return {"the task has ended; the robot does task " + std::to_string(task->id), kExitFailed};
  }
  if (task->state == "active") {
    return {robot_line(*robot) + "  " + with_why(task_text(*task), task->why), std::nullopt};
  }
  const bool done = task->state == "done";
  return {with_why(robot_ + " " + task_text(*task), task->why), done ? kExitOk : kExitFailed};
}

}  // namespace cairn::cli
