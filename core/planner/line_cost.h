#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/planner/ground.h"

namespace cairn {

/// What driving along straight lines costs, on the same ground as a field but measured along the
/// line itself: price of each cell times the length in it, and every rise and fall of the surface
/// through the cells' middles.
class LineCost {
 public:
  /// The grid must outlive it.
  explicit LineCost(const DrivableGrid& grid);

  /// [cost units, levelled] Nothing where the line touches a closed cell or a step beyond the
  /// limits. Points [m] in the site frame, finite and within HeightMap::kMaxExtentM.
  [[nodiscard]] std::optional<double> between(const Eigen::Vector2d& from_m,
                                              const Eigen::Vector2d& to_m) const;
  /// The same for a line that is known to be open.
  [[nodiscard]] double along(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) const;

  /// [cost units] Lift of the surface at a place [cells of the grid].
  [[nodiscard]] double lift_at(const Eigen::Vector2d& place) const;

 private:
  [[nodiscard]] bool drivable(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) const;
  [[nodiscard]] Eigen::Vector2d in_cells(const Eigen::Vector2d& point_m) const;
  [[nodiscard]] double price_at(double x, double y) const;

  const DrivableGrid& grid_;
  const double cell_m_;
  bool uniform_;  ///< All open ground costs the same.
  bool uneven_;   ///< Some steps have rules of their own.
};

}  // namespace cairn
