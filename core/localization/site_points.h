#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/localization/site_pyramid.h"
#include "core/map/height_map.h"
#include "core/pose/pose.h"

namespace cairn {

/// A known cell of a short-term map.
struct ShownCell {
  Eigen::Vector2d from_robot;  ///< [cells] Along the short-term map's axes.
  double height_mm = 0.0;      ///< [mm] Above the robot's foot.
  bool face = false;           ///< It stands above the ground.
};

/// The cells at most `reach_m` from the robot, by y, then x; at most `faces` and `flats` of each
/// kind, spread evenly. Requires: a finite pose, known cells near it.
[[nodiscard]] std::vector<ShownCell> shown_cells(const HeightMap& short_term,
                                                 const Pose& T_submap_robot, double reach_m,
                                                 int faces, int flats);

/// Turned by `yaw_rad` (the site's yaw of the short-term map's axes). [far_sigma: m per m]
[[nodiscard]] std::vector<SitePoint> turned_points(const std::vector<ShownCell>& cells,
                                                   double yaw_rad, int unit_mm, double cell_m,
                                                   double far_sigma);

}  // namespace cairn
