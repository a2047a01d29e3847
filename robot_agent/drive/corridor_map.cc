#include "robot_agent/drive/corridor_map.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace cairn::agent {

namespace {

Eigen::Vector2d goal_of(const proto::Command& command) {
  return {command.goal_x_mm / 1000.0, command.goal_y_mm / 1000.0};
}

Eigen::Vector2d nearest_on_leg(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                               const Eigen::Vector2d& p) {
  const Eigen::Vector2d way = b - a;
  const double length2 = way.squaredNorm();
  return length2 > 0.0 ? Eigen::Vector2d(a + std::clamp((p - a).dot(way) / length2, 0.0, 1.0) * way)
                       : a;
}

/// Points of a path as driven: the last one is the goal itself where the path leads there.
std::vector<Eigen::Vector2d> points_to(const Eigen::Vector2d& goal_m, const CodedPath& coded) {
  std::vector<Eigen::Vector2d> points_m = coded.points_m();
  const auto goal = quantise({goal_m}, coded.cell_size_mm);
  if (goal && goal->points.front() == coded.points.back()) points_m.back() = goal_m;
  return points_m;
}

}  // namespace

Result<OrderedPath> read_path(const proto::Command& command,
                              const std::vector<std::uint8_t>& bytes) {
  auto coded = decode_path(bytes);
  if (!coded) return coded.error();
  if (coded->points.empty()) return Error{ErrorCode::invalid_argument, "the path has no points"};
  auto points_m = points_to(goal_of(command), *coded);
  return OrderedPath{std::move(*coded), std::move(points_m)};
}

CorridorMap::CorridorMap(const proto::Command& command, OrderedPath path)
    : command_(command.id),
      revision_(command.revision),
      path_cut_(command.path_cut),
      path_(std::move(path)),
      goal_m_(goal_of(command)) {}

Status CorridorMap::take(const proto::CorridorPart& corridor, int cell_size_mm) {
  if (corridor.command != command_ || corridor.revision != revision_) {
    return Error{ErrorCode::conflict, "the corridor is another order's"};
  }
  Part part{.map_version = corridor.map_version,
            .half_width = corridor.half_width,
            .own_path = !corridor.spine.empty(),
            .path_m = path_.points_m,
            .to_goal = !path_cut_,
            .corridor = {}};
  CodedPath path = path_.coded;
  if (part.own_path) {
    auto own = decode_path(corridor.spine);
    if (!own) return own.error();
    path = std::move(*own);
    if (path.points.empty()) return Error{ErrorCode::invalid_argument, "a corridor without a path"};
    part.path_m = points_to(goal_m_, path);
    part.to_goal = part.path_m.back() == goal_m_;
  }
  const std::size_t end = std::size_t{corridor.first} + corridor.count;
  if (end > path.points.size() || path.cell_size_mm != cell_size_mm) {
    return Error{ErrorCode::invalid_argument, "the corridor is of another path, or other cells"};
  }
  part.last = end - 1;
  const auto begin = path.points.begin() + corridor.first;
  auto cells =
      Corridor::along({cell_size_mm, {begin, begin + corridor.count}}, corridor.half_width);
  if (!cells) return cells.error();
  if (Status read = cells->decode(corridor.directions); !read) return read;
  part.corridor = std::move(*cells);
  cell_m_ = cell_size_mm / 1000.0;
  const auto older = std::ranges::find_if(
      parts_, [&](const Part& other) { return other.map_version <= part.map_version; });
  parts_.insert(older, std::move(part));
  if (parts_.size() > kMaxParts) parts_.pop_back();
  return {};
}

const CorridorMap::Part* CorridorMap::part_at(CellIndex cell) const {
  const auto found = std::ranges::find_if(
      parts_, [&](const Part& part) { return part.corridor.direction(cell) != Corridor::outside; });
  return found == parts_.end() ? nullptr : &*found;
}

std::uint8_t CorridorMap::direction(CellIndex cell) const {
  const Part* part = part_at(cell);
  return part == nullptr ? std::uint8_t{Corridor::outside} : part->corridor.direction(cell);
}

std::optional<CorridorMap::Rest> CorridorMap::rest_from(CellIndex cell) const {
  const Part* part = part_at(cell);
  if (part == nullptr) return std::nullopt;
  const Eigen::Vector2d place_m((cell.x + 0.5) * cell_m_, (cell.y + 0.5) * cell_m_);
  const double end_reach_m = (part->half_width + 1.5) * cell_m_;
  if ((part->path_m[part->last] - place_m).norm() > end_reach_m) return std::nullopt;
  Eigen::Vector2d foot_m = part->path_m[part->last];
  std::size_t next = part->last + 1;
  for (std::size_t i = part->last; i + 1 < part->path_m.size(); ++i) {
    const Eigen::Vector2d nearest_m = nearest_on_leg(part->path_m[i], part->path_m[i + 1], place_m);
    if ((nearest_m - place_m).norm() >= (foot_m - place_m).norm()) break;
    foot_m = nearest_m;
    next = i + 1;
  }
  Rest rest{{foot_m}, part->to_goal};
  for (std::size_t i = next; i < part->path_m.size(); ++i) rest.points_m.push_back(part->path_m[i]);
  return rest;
}

}  // namespace cairn::agent
