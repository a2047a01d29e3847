#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/planner/trulla.h"

namespace cairn {

enum class PathStatus : std::uint8_t {
  complete,  ///< Leads to the goal.
  partial,   ///< Leads to the reachable place nearest the goal (only when asked for).
  none,      ///< `why` says what is in the way.
};

struct Path {
  PathStatus status = PathStatus::none;
  std::string why;                        ///< Empty when complete.
  std::vector<Eigen::Vector2d> points_m;  ///< In the site frame, from the start to the end.
  double length_m = 0.0;
  /// [m of level driving] along the field from the start; leaving a closed start counts its length.
  double cost_m = 0.0;
  /// With UnknownGround::explore, where no way is known: the last place on known ground of the best
  /// way over ground that nobody has seen. Looking on from there might open it (T4.3.2).
  std::optional<Eigen::Vector2d> frontier_m;
};

struct PlanRequest {
  Eigen::Vector2d start_m;
  Eigen::Vector2d goal_m;
  bool allow_partial = false;
  /// [m] The path's points may be simplified by this much, never through a closed cell.
  double tolerance_m = 0.06;
};

/// Plans with Trulla from start to goal. A start in a closed cell (too near an obstacle, or on
/// unknown ground) first leaves it by the shortest straight way to an open cell within
/// 2 · radius + 2 cells (256 cells at most) from which the goal can be reached; that way passes no
/// obstacle and no step beyond the limits. The path begins at the true start and, when complete,
/// ends at the exact goal; a partial one ends at the middle of a cell. Goals outside the map, on an
/// obstacle, too near one, unknown, or cut off give `none` with that reason, or `partial` when
/// allowed; with UnknownGround::explore they say which frontier would open a way, and a partial
/// path leads there. Non-finite coordinates give `none`. The grid must have been made with the
/// config.
[[nodiscard]] Path plan(const DrivableGrid& grid, const PlanRequest& request,
                        const PlannerConfig& config);

/// The same with the field at hand. Requires: the field is of this grid and leads to the goal's
/// cell; where that is closed it has not been reached.
[[nodiscard]] Path plan(const DrivableGrid& grid, const Field& field, const PlanRequest& request,
                        const PlannerConfig& config);

/// Fewer points: drops those within `tolerance_m` of the line between kept ones (Douglas & Peucker
/// 1973) where that line crosses only open cells, cutting no corner, and no step beyond the limits
/// in the direction of travel. Corners are looked at 1024 at a time, which bounds the time.
[[nodiscard]] std::vector<Eigen::Vector2d> simplify(const DrivableGrid& grid,
                                                    const std::vector<CellIndex>& cells,
                                                    double tolerance_m);

/// The same for points [m]; the first and the last are kept.
[[nodiscard]] std::vector<Eigen::Vector2d> simplify(const DrivableGrid& grid,
                                                    const std::vector<Eigen::Vector2d>& points_m,
                                                    double tolerance_m);

/// Whether the straight line crosses only open cells (every cell it touches, corners included).
[[nodiscard]] bool line_is_open(const DrivableGrid& grid, const Eigen::Vector2d& from_m,
                                const Eigen::Vector2d& to_m);

/// Why no path whatever can begin there; empty when some can. Requires: it is finite.
[[nodiscard]] std::string why_shut_in(const DrivableGrid& grid, const Eigen::Vector2d& place_m);

}  // namespace cairn
