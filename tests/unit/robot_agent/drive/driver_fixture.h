#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "robot_agent/drive/driver.h"
#include "tests/unit/robot_agent/drive/rolling_robot.h"

namespace cairn::agent {

using proto::CommandKind;
using proto::CommandReport;
using proto::CommandState;
using proto::DriveState;
using proto::OnLinkLoss;
using std::chrono::milliseconds;
using std::chrono::seconds;

inline constexpr int kCellMm = 125;
inline constexpr double kCellM = 0.125;

inline proto::RobotLink::Order go_to(std::uint64_t id, const std::vector<Eigen::Vector2d>& path_m,
                                     std::uint32_t revision = 1) {
  proto::RobotLink::Order order;
  order.command.id = id;
  order.command.revision = revision;
  order.command.kind = CommandKind::go_to;
  order.command.issuer = "Ada";
  order.command.expires_clock_ms = 1'000'000;
  order.command.on_link_loss = OnLinkLoss::stop;
  order.command.link_timeout_ms = 5'000;
  if (path_m.empty()) return order;
  order.path = encode_path(quantise(path_m, kCellMm).value());
  order.command.path_bytes = static_cast<std::uint16_t>(order.path.size());
  order.command.goal_x_mm = static_cast<std::int32_t>(std::lround(path_m.back().x() * 1000.0));
  order.command.goal_y_mm = static_cast<std::int32_t>(std::lround(path_m.back().y() * 1000.0));
  return order;
}

inline proto::RobotLink::Order stop(std::uint64_t id, std::uint32_t revision = 1) {
  proto::RobotLink::Order order;
  order.command.id = id;
  order.command.revision = revision;
  order.command.kind = CommandKind::stop;
  order.command.issuer = "Grace";
  order.command.expires_clock_ms = 1'000'000;
  return order;
}

/// A robot on flat ground, its driver, and everything that the driver reported.
class DriverTest : public ::testing::Test {
 protected:
  Driver driver{DriverConfig{}};
  Pose pose;
  MonotonicTime clock = seconds(100);
  std::optional<Duration> silence = Duration{};
  CellLookup cells = [](CellIndex) { return Cell{0, 200}; };
  std::vector<CommandReport> reports;
  DriveCommand wheels;

  void take(const proto::RobotLink::Order& order) {
    driver.take(order, pose, clock);
    listen();
  }
  void step() {
    wheels = driver.step(pose, cells, kCellMm, 25, clock, silence);
    testing::roll(pose, wheels);
    clock += from_seconds(testing::kStepS);
    listen();
  }
  void run(Duration time) {
    for (const MonotonicTime end = clock + time; clock < end;) step();
  }
  [[nodiscard]] std::vector<CommandState> states() const {
    std::vector<CommandState> states;
    for (const CommandReport& report : reports) states.push_back(report.state);
    return states;
  }
  void listen() {
    for (CommandReport& report : driver.take_reports()) reports.push_back(std::move(report));
  }
  /// 0.5 m deep, 1 m wide, across the way.
  void box_at(double x_m) {
    cells = [x_m](CellIndex cell) {
      const double ahead_m = cell.x * kCellM - x_m;
      const bool box = ahead_m >= 0.0 && ahead_m < 0.5 && cell.y >= -4 && cell.y < 4;
      return Cell{box ? 1000 : 0, 200};
    };
  }
  void wall_at(double x_m) {
    cells = [x_m](CellIndex cell) { return Cell{cell.x * kCellM >= x_m ? 1000 : 0, 200}; };
  }
};

}  // namespace cairn::agent
