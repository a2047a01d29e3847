#include "core/planner/line_cost.h"

#include <cmath>

#include "core/planner/plan.h"
#include "core/planner/touched_cells.h"

namespace cairn {

LineCost::LineCost(const DrivableGrid& grid)
    : grid_(grid),
      cell_m_(grid.heights.cell_size_mm / 1000.0),
      uniform_(grid.ground.uniform),
      uneven_(grid.ground.uneven) {}

Eigen::Vector2d LineCost::in_cells(const Eigen::Vector2d& point_m) const {
  return point_m / cell_m_ - Eigen::Vector2d(grid_.heights.origin.x, grid_.heights.origin.y);
}

bool LineCost::drivable(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) const {
  const TouchedCells cells(from_m, to_m, cell_m_);
  return cells.all([&](CellIndex cell) {
    return grid_.heights.contains(cell) && grid_.open[grid_.heights.at(cell)] != 0;
  }) && (!uneven_ || steps_within_limits(grid_, cells));
}

std::optional<double> LineCost::between(const Eigen::Vector2d& from_m,
                                        const Eigen::Vector2d& to_m) const {
  if (!drivable(from_m, to_m)) return {};
  return along(from_m, to_m);
}

double LineCost::price_at(double x, double y) const {
  const int column = std::clamp(static_cast<int>(x), 0, grid_.heights.width - 1);
  const int row = std::clamp(static_cast<int>(y), 0, grid_.heights.height - 1);
  const int price = grid_.ground.price[grid_.ground.at(column, row)] & PricedGround::kPriceMask;
  return price != 0 ? price : kCellUnits;  // Leaving a closed start costs its length.
}

double LineCost::lift_at(const Eigen::Vector2d& place) const {
  const double x = std::clamp(place.x() - 0.5, 0.0, grid_.heights.width - 1.0);
  const double y = std::clamp(place.y() - 0.5, 0.0, grid_.heights.height - 1.0);
  const double fx = x - std::floor(x);
  const double fy = y - std::floor(y);
  const std::size_t corner = grid_.ground.at(static_cast<int>(x), static_cast<int>(y));
  const auto stride = static_cast<std::size_t>(grid_.ground.stride);
  double weights = 0.0;
  double sum = 0.0;
  const auto add = [&](std::size_t cell, double weight) {
    if (grid_.ground.price[cell] == 0 || weight == 0.0) return;
    weights += weight;
    sum += weight * grid_.ground.lift[cell];
  };
  add(corner, (1 - fx) * (1 - fy));
  add(corner + 1, fx * (1 - fy));
  add(corner + stride, (1 - fx) * fy);
  add(corner + stride + 1, fx * fy);
  return weights > 0.0 ? sum / weights : 0.0;
}

double LineCost::along(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) const {
  const Eigen::Vector2d a = in_cells(from_m);
  const Eigen::Vector2d way = in_cells(to_m) - a;
  const double length = way.norm();
  if (uniform_ || length == 0.0) return length * kCellUnits;

  // From one line through the cells' middles to the next, along the longer axis; half-way between
  // them lies the border between two columns (or rows) of cells.
  const int axis = std::abs(way.x()) >= std::abs(way.y()) ? 0 : 1;
  const double speed = std::abs(way[axis]);
  const double ahead = way[axis] > 0 ? std::ceil(a[axis] - 0.5 + 1e-9) + 0.5 - a[axis]
                                     : a[axis] - (std::floor(a[axis] - 0.5 - 1e-9) + 0.5);
  double lift = lift_at(a);
  double cost = 0.0;
  double done = 0.0;
  for (double next = ahead / speed; done < 1.0; next += 1.0 / speed) {
    const double end = std::min(next, 1.0);
    const Eigen::Vector2d p = a + way * (done + (end - done) * 0.25);
    const Eigen::Vector2d q = a + way * (done + (end - done) * 0.75);
    const double price = (price_at(p.x(), p.y()) + price_at(q.x(), q.y())) / 2;
    const double end_lift = lift_at(a + way * end);
    cost += (end - done) * length * price + std::abs(end_lift - lift);
    lift = end_lift;
    done = end;
  }
  return cost;
}

}  // namespace cairn
