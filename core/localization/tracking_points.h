#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/pose/pose.h"
#include "core/sensor/laser.h"

namespace cairn {

/// A point on a surface that a level laser met, seen from above.
struct SurfacePoint {
  Eigen::Vector2d p_m;
  Eigen::Vector2d normal;  ///< Unit length, towards the laser.
};

struct SurfacePointsConfig {
  double range_m = 30.0;    ///< [m] Hits beyond it are left out.
  double spacing_m = 0.05;  ///< [m] Neighbours along the sweep that are nearer are left out.
  /// [m] The surface around a hit is looked for so far to either side,
  double surface_m = 0.25;
  /// and at least over so many of the next hits (far away they lie wide apart),
  int least_neighbours = 2;
  /// [-] which may lie at most so much off the line through them, in parts of its length.
  double roughness = 0.2;
  /// [rad] A surface seen more slantingly is an edge that the sweep runs past.
  double slant_rad = 0.14;
};

/// The surfaces that a sweep met, along the axes of a level frame at the robot's foot. `attitude`:
/// roll and pitch of the robot; the rest of it is ignored.
[[nodiscard]] std::vector<SurfacePoint> surface_points(const Scan& scan, const LaserSpec& laser,
                                                       const Pose& attitude,
                                                       const SurfacePointsConfig& config);

}  // namespace cairn
