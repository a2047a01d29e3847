#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/planner/trulla.h"

namespace cairn {

/// What exploring looks for (T2.2.3, T4.3.5; Yamauchi 1997).
struct FrontierConfig {
  /// [m] Frontier cells this near the cheapest one belong to it. [Limit: > 0]
  double reach_m = 1.5;
  /// [m] From a frontier so much unseen ground may come into view. [Limit: > 0]
  double view_m = 2.5;
  /// [m²] Frontiers that promise less are left alone: gaps between beams. [Limit: ≥ 0]
  double min_area_m2 = 0.3;
  /// [m] The way that is added before area is divided by way: the larger, the more area counts.
  double head_start_m = 2.0;
};

/// A rectangle of the site.
struct AreaM {
  double west_m = 0.0;
  double south_m = 0.0;
  double east_m = 0.0;
  double north_m = 0.0;

  [[nodiscard]] bool contains(const Eigen::Vector2d& place_m) const {
    return place_m.x() >= west_m && place_m.x() <= east_m && place_m.y() >= south_m &&
           place_m.y() <= north_m;
  }
};

/// A stretch of the edge between ground that can be driven to and ground nobody has seen.
struct Frontier {
  Eigen::Vector2d place_m;      ///< The middle of its cheapest cell: open, known, reachable.
  double way_m = 0.0;           ///< To there.
  double new_area_m2 = 0.0;     ///< Unseen ground that hangs together with it, within view.
  std::vector<CellIndex> edge;  ///< All its cells, that one first.
  /// [m²/m] new_area / (head_start + way): the order of frontiers.
  double promise = 0.0;
};

/// All frontiers that a vehicle at `from_m` can drive to, the most promising first; of equals the
/// nearer one. With an area only what lies in it counts, cells and promised ground.
/// Time and memory (6 bytes) go with the grid's cells, and with view² per frontier.
/// Requires: a grid made for unknown ground that is blocked.
[[nodiscard]] std::vector<Frontier> find_frontiers(const DrivableGrid& grid,
                                                   const Eigen::Vector2d& from_m,
                                                   const FrontierConfig& config,
                                                   const std::optional<AreaM>& area = {});

}  // namespace cairn
