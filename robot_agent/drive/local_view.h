#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/map/cell.h"
#include "core/planner/plan.h"

namespace cairn::agent {

/// What the driver may look at: the robot's own map, cell by cell.
using CellLookup = std::function<Cell(CellIndex)>;

/// What lies on the way just ahead.
struct Ahead {
  double clear_m = 0.0;    ///< Way along the path until something closes it.
  double unknown_m = 0.0;  ///< Longest stretch of unseen ground within the look-ahead.
  double known_m = 0.0;    ///< Way along the path until the first unseen ground.
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

 private:
  [[nodiscard]] bool open_at(const Eigen::Vector2d& p_m) const;
  [[nodiscard]] bool known_at(const Eigen::Vector2d& p_m) const;
  [[nodiscard]] CellIndex cell_at(const Eigen::Vector2d& p_m) const;

  DrivableGrid grid_;
  double radius_m_;
};

}  // namespace cairn::agent
