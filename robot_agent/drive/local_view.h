#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "core/map/cell.h"
#include "core/planner/plan.h"

namespace cairn::agent {

/// What the driver may look at: the robot's own map, cell by cell.
using CellLookup = std::function<Cell(CellIndex)>;

/// Fills the grid from the robot's map; cells below `min_probability` stay unknown.
void copy_known(const CellLookup& cells, std::uint8_t min_probability, HeightGrid& grid);

/// A stretch of the way that nobody has seen.
struct Gap {
  double from_m = 0.0;    ///< Way to its beginning.
  double length_m = 0.0;  ///< As far as it was looked at.
  /// Difference in height of the ground on both sides; infinite where a side is not seen.
  double rise_m = std::numeric_limits<double>::infinity();
};

/// What lies on the way just ahead.
struct Ahead {
  double clear_m = 0.0;    ///< Way along the path until something closes it.
  double known_m = 0.0;    ///< Way along the path until the first unseen ground.
  std::optional<Gap> gap;  ///< The first unseen stretch of kGapM or more before that.
};

/// Looks along a path on the robot's own map, from what the lasers have seen so far.
class LocalView {
 public:
  /// `centre_m` in the site frame; the window reaches `reach_m` to each side.
  LocalView(const CellLookup& cells, int cell_size_mm, std::uint8_t min_probability,
            const Eigen::Vector2d& centre_m, double reach_m, const VehicleLimits& limits);

  /// Follows the path from the window's centre for `distance_m`. Where the centre itself is in a
  /// closed cell the first `limits.radius_m` is not judged: one has to be able to leave.
  [[nodiscard]] Ahead look_along(const std::vector<Eigen::Vector2d>& path_m,
                                 double distance_m) const;

  /// Whether the circle of `limits.radius_m` around it is free of obstacles.
  [[nodiscard]] bool open_at(const Eigen::Vector2d& p_m) const;
  /// How many obstacle cells lie within `reach_m` of a place along x and y, by their middles, and
  /// where, relative to it, `counts` says so.
  template <class Counts>
  [[nodiscard]] int count_obstacles(const Eigen::Vector2d& place_m, double reach_m,
                                    const Counts& counts) const;

  /// [m] Shorter unseen stretches are gaps between beams; a longer one may hide a drop.
  static constexpr double kGapM = 0.6;

 private:
  [[nodiscard]] bool known_at(const Eigen::Vector2d& p_m) const;
  /// Requires: known_at(p_m).
  [[nodiscard]] double height_m(const Eigen::Vector2d& p_m) const;
  [[nodiscard]] CellIndex cell_at(const Eigen::Vector2d& p_m) const;

  DrivableGrid grid_;
  double radius_m_;
};

template <class Counts>
int LocalView::count_obstacles(const Eigen::Vector2d& place_m, double reach_m,
                               const Counts& counts) const {
  const double cell_m = grid_.heights.cell_size_mm / 1000.0;
  const Eigen::Vector2d reach(reach_m, reach_m);
  const CellIndex lowest = cell_at(place_m - reach);
  const CellIndex highest = cell_at(place_m + reach);
  int count = 0;
  for (std::int32_t y = lowest.y; y <= highest.y; ++y) {
    for (std::int32_t x = lowest.x; x <= highest.x; ++x) {
      if (!grid_.heights.contains({x, y})) continue;
      if (grid_.classes[grid_.heights.at({x, y})] != CellClass::obstacle) continue;
      if (counts(Eigen::Vector2d((x + 0.5) * cell_m, (y + 0.5) * cell_m) - place_m)) ++count;
    }
  }
  return count;
}

}  // namespace cairn::agent
