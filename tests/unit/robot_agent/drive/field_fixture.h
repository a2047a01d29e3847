#pragma once

#include "core/planner/corridor.h"
#include "core/planner/field_walk.h"
#include "proto/codec/records.h"
#include "tests/unit/robot_agent/drive/driver_fixture.h"

namespace cairn::agent::testing {

/// Level ground around the origin, as the server's map knows it.
inline DrivableGrid level_ground(double reach_m = 25.0) {
  const auto reach = static_cast<std::int32_t>(reach_m / kCellM);
  HeightGrid heights = empty_grid({-reach, -reach}, {reach, reach}, kCellMm).value();
  std::fill(heights.probability.begin(), heights.probability.end(), std::uint8_t{200});
  return make_drivable(std::move(heights), {});
}

inline CellIndex cell_at(const Eigen::Vector2d& p_m) {
  return {static_cast<std::int32_t>(std::floor(p_m.x() / kCellM)),
          static_cast<std::int32_t>(std::floor(p_m.y() / kCellM))};
}

/// The field towards `goal_m` along a path.
inline Corridor corridor_to(const Eigen::Vector2d& goal_m, const CodedPath& path, int half_width) {
  const DrivableGrid ground = level_ground();
  const Field field = compute_field(ground, cell_at(goal_m)).value();
  Corridor corridor = Corridor::along(path, half_width).value();
  corridor.fill(ground, field);
  return corridor;
}

/// What a server sends for the whole path of an order.
inline proto::CorridorPart corridor_of(const proto::RobotLink::Order& order, int half_width,
                                       const Eigen::Vector2d& goal_m) {
  const CodedPath path = decode_path(order.path).value();
  return {.command = order.command.id,
          .revision = order.command.revision,
          .map_version = 1,
          .first = 0,
          .count = static_cast<std::uint16_t>(path.points.size()),
          .half_width = static_cast<std::uint8_t>(half_width),
          .spine = {},
          .directions = corridor_to(goal_m, path, half_width).encode()};
}

inline proto::CorridorPart corridor_of(const proto::RobotLink::Order& order, int half_width) {
  return corridor_of(order, half_width,
                     {order.command.goal_x_mm / 1000.0, order.command.goal_y_mm / 1000.0});
}

}  // namespace cairn::agent::testing
