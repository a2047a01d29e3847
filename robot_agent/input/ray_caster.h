#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "robot_agent/input/height_raster.h"

namespace cairn::agent {

/// Where a ray first meets the surface. Exact for the bilinear surface: in every cell the ray's
/// height above it is a quadratic in the range. Blocks of cells whose highest point lies below the
/// ray are skipped at once.
class RayCaster {
 public:
  /// Keeps a reference: `surface` must outlive the caster and not change.
  explicit RayCaster(const HeightRaster& surface);

  /// [m] Range to the surface (or to the wall around the raster) from `origin` along the unit
  /// vector `direction`; `max_range_m` when there is nothing before. 0 below the surface.
  [[nodiscard]] double range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                               double max_range_m) const;

 private:
  /// The highest points of square blocks of cells.
  struct Blocks {
    int cells;  ///< Along a side.
    int columns;
    std::vector<float> highest_m;
  };
  struct Ray;

  [[nodiscard]] static Blocks highest_points(const HeightRaster& surface, int cells);
  [[nodiscard]] double skip(const Ray& ray, const Blocks& blocks, double from_m) const;

  const HeightRaster& surface_;
  std::array<Blocks, 3> levels_;  ///< From coarse to fine.
};

}  // namespace cairn::agent
