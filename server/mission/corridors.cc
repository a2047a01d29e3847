#include "server/mission/corridors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace cairn::server {

namespace {

/// [1/4 cells] A leg along x or y: a stretch of kStretchM holds a few.
constexpr std::int32_t kMostLeg = 512;
/// [cells] A robot this near to its path asks for more of the corridor along it.
constexpr double kBesideCells = 12.0;

double length_m(const CodedPath& path, std::size_t from, std::size_t to) {
  double quarters = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    quarters += std::hypot(path.points[i + 1].x - path.points[i].x,
                           path.points[i + 1].y - path.points[i].y);
  }
  return quarters / 4.0 * path.cell_size_mm / 1000.0;
}

bool leads_anywhere(const Corridor& corridor, const CodedPath& stretch) {
  return std::ranges::any_of(stretch.points, [&](CellIndex p) {
    return corridor.direction({p.x >> 2, p.y >> 2}) <= Corridor::at_goal;
  });
}

/// `count` points from `first` on; nullopt when they do not fit into a record.
std::optional<proto::CorridorPart> part_of(const CodedPath& path, std::size_t first,
                                           std::size_t count, const KeptField& field,
                                           const CorridorNeed& need) {
  const auto begin = path.points.begin() + static_cast<std::ptrdiff_t>(first);
  const CodedPath stretch{path.cell_size_mm, {begin, begin + static_cast<std::ptrdiff_t>(count)}};
  auto corridor = Corridor::along(stretch, need.half_width);
  if (!corridor || !field.fill(*corridor)) return std::nullopt;
  if (!leads_anywhere(*corridor, stretch)) return std::nullopt;
  proto::CorridorPart part{.command = need.command,
                           .revision = need.revision,
                           .map_version = need.map_version,
                           .first = static_cast<std::uint16_t>(first),
                           .count = static_cast<std::uint16_t>(count),
                           .half_width = static_cast<std::uint8_t>(need.half_width),
                           .spine = {},
                           .directions = corridor->encode()};
  if (part.directions.empty()) part.directions.push_back(0);  // What a decoder takes for nothing.
  if (part.directions.size() > proto::kMaxCorridorBytes) return std::nullopt;
  return part;
}

/// How many points make kStretchM of way.
std::size_t stretch_from(const CodedPath& path, std::size_t first) {
  std::size_t last = first;
  while (last + 1 < path.points.size() && length_m(path, first, last) < kStretchM) ++last;
  return last - first + 1;
}

/// The path's point after which `place_m` lies beside it; nullopt when it does not.
std::optional<std::size_t> leg_beside(const CodedPath& path, const Eigen::Vector2d& place_m) {
  const Eigen::Vector2d p = place_m * (4000.0 / path.cell_size_mm);
  std::optional<std::size_t> leg;
  double nearest = 4.0 * kBesideCells;
  for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
    const Eigen::Vector2d a(path.points[i].x, path.points[i].y);
    const Eigen::Vector2d way = Eigen::Vector2d(path.points[i + 1].x, path.points[i + 1].y) - a;
    const double t = std::clamp((p - a).dot(way) / std::max(way.squaredNorm(), 1.0), 0.0, 1.0);
    const double distance = (p - a - t * way).norm();
    if (distance > nearest) continue;
    nearest = distance;
    leg = i;
  }
  return leg;
}

}  // namespace

WirePath to_wire(const std::vector<Eigen::Vector2d>& points_m, int cell_size_mm,
                 std::size_t most_bytes) {
  WirePath wire;
  if (points_m.empty()) return wire;
  std::vector<Eigen::Vector2d> some_m = points_m;
  const std::size_t most_points = CodedPath::kMaxPoints / 4;
  if (some_m.size() > most_points) some_m.resize(most_points);
  auto coded = quantise(some_m, cell_size_mm);
  if (!coded) return wire;
  wire.path = subdivided(*coded, kMostLeg);
  wire.cut = some_m.size() < points_m.size();
  wire.bytes = encode_path(wire.path);
  while (wire.bytes.size() > most_bytes || wire.path.points.size() > CodedPath::kMaxPoints) {
    wire.cut = true;
    wire.path.points.resize(
        std::min(wire.path.points.size() - 1, wire.path.points.size() * 9 / 10));
    wire.bytes = encode_path(wire.path);
  }
  return wire;
}

std::vector<proto::CorridorPart> corridor_along(const CodedPath& path, std::size_t first,
                                                const KeptField& field, const CorridorNeed& need) {
  std::vector<proto::CorridorPart> parts;
  while (parts.size() < static_cast<std::size_t>(need.stretches) &&
         (first + 1 < path.points.size() || path.points.size() == 1)) {
    std::size_t count = stretch_from(path, first);
    auto part = part_of(path, first, count, field, need);
    while (!part && count > 2) {
      count = (count + 2) / 2;
      part = part_of(path, first, count, field, need);
    }
    if (!part) break;
    parts.push_back(*std::move(part));
    if (path.points.size() == 1) break;
    first += count - 1;
  }
  return parts;
}

std::vector<proto::CorridorPart> corridor_from(const CodedPath& path, const PlanTarget& target,
                                               const KeptField& field, const CorridorNeed& need) {
  if (const auto leg = leg_beside(path, target.request.start_m)) {
    return corridor_along(path, *leg, field, need);
  }
  const Path way = field.plan(target);
  if (way.status != PathStatus::complete) return {};
  const WirePath own = to_wire(way.points_m, path.cell_size_mm, proto::kMaxSpineBytes);
  CorridorNeed once = need;
  once.stretches = 1;
  auto parts = corridor_along(own.path, 0, field, once);
  for (proto::CorridorPart& part : parts) part.spine = own.bytes;
  return parts;
}

}  // namespace cairn::server
