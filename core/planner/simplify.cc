#include <algorithm>
#include <cmath>
#include <utility>

#include "core/planner/plan.h"
#include "core/planner/touched_cells.h"

namespace cairn {
namespace {

using Points = std::vector<Eigen::Vector2d>;

/// [m] Points this near a straight run lie on it.
constexpr double kStraightM = 1e-6;
/// Corners looked at together: bounds the time of Douglas & Peucker's worst case.
constexpr std::size_t kMaxSpan = 1024;

double cell_m(const DrivableGrid& grid) { return grid.heights.cell_size_mm / 1000.0; }

double distance_to_line(const Eigen::Vector2d& point, const Eigen::Vector2d& from,
                        const Eigen::Vector2d& to) {
  const Eigen::Vector2d way = to - from;
  const double length2 = way.squaredNorm();
  const double along = length2 > 0 ? std::clamp((point - from).dot(way) / length2, 0.0, 1.0) : 0.0;
  return (point - from - along * way).norm();
}

/// Only the ends and the places where the way turns.
Points corners_of(const Points& points) {
  Points corners;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool end = i == 0 || i + 1 == points.size();
    if (end || distance_to_line(points[i], corners.back(), points[i + 1]) > kStraightM) {
      corners.push_back(points[i]);
    }
  }
  return corners;
}

struct Span {
  std::size_t first;
  std::size_t last;
};

/// The point between the ends that is farthest from their line; the middle one when all lie on it.
std::pair<std::size_t, double> farthest(const Points& points, Span span) {
  std::pair<std::size_t, double> best{span.first + (span.last - span.first) / 2, 0.0};
  for (std::size_t i = span.first + 1; i < span.last; ++i) {
    const double distance_m = distance_to_line(points[i], points[span.first], points[span.last]);
    if (distance_m > best.second) best = {i, distance_m};
  }
  return best;
}

bool drivable_line(const DrivableGrid& grid, const Eigen::Vector2d& from_m,
                   const Eigen::Vector2d& to_m) {
  return line_is_open(grid, from_m, to_m) &&
         steps_within_limits(grid, TouchedCells(from_m, to_m, cell_m(grid)));
}

/// Last points of the kept pieces between the ends of a span, in order.
void keep_within(const DrivableGrid& grid, const Points& points, Span whole, double tolerance_m,
                 Points& kept) {
  std::vector<Span> waiting{whole};
  while (!waiting.empty()) {
    const Span span = waiting.back();
    waiting.pop_back();
    const auto [middle, distance_m] = farthest(points, span);
    const bool atomic = span.last - span.first < 2;
    if (atomic ||
        (distance_m <= tolerance_m && drivable_line(grid, points[span.first], points[span.last]))) {
      kept.push_back(points[span.last]);
    } else {
      waiting.push_back({middle, span.last});
      waiting.push_back({span.first, middle});
    }
  }
}

}  // namespace

bool line_is_open(const DrivableGrid& grid, const Eigen::Vector2d& from_m,
                  const Eigen::Vector2d& to_m) {
  const auto on_earth = [](const Eigen::Vector2d& p) {
    return p.allFinite() && p.cwiseAbs().maxCoeff() < HeightMap::kMaxExtentM;
  };
  if (!on_earth(from_m) || !on_earth(to_m)) return false;
  return TouchedCells(from_m, to_m, cell_m(grid)).all([&](CellIndex cell) {
    return grid.heights.contains(cell) && grid.open[grid.heights.at(cell)] != 0;
  });
}

Points simplify(const DrivableGrid& grid, const Points& points_m, double tolerance_m) {
  Points corners = corners_of(points_m);
  if (corners.size() < 3) return corners;
  Points kept{corners.front()};
  for (std::size_t first = 0; first + 1 < corners.size(); first += kMaxSpan) {
    const std::size_t last = std::min(first + kMaxSpan, corners.size() - 1);
    keep_within(grid, corners, {first, last}, tolerance_m, kept);
  }
  return kept;
}

Points simplify(const DrivableGrid& grid, const std::vector<CellIndex>& cells, double tolerance_m) {
  Points middles_m;
  middles_m.reserve(cells.size());
  for (const CellIndex cell : cells) {
    middles_m.emplace_back((cell.x + 0.5) * cell_m(grid), (cell.y + 0.5) * cell_m(grid));
  }
  return simplify(grid, middles_m, tolerance_m);
}

}  // namespace cairn
