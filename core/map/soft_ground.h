#pragma once

#include <cstdint>
#include <vector>

#include "core/map/terrain_kernels.h"
#include "core/map/traversability.h"

namespace cairn {

/// What a step between cells is judged by beyond its height (T5.3).
struct SoftLimits {
  double sigma_mm = 15.0;     ///< Of a cell's height, by the sensor. [Limit: 1 … 1000]
  double wheel_base_m = 0.5;  ///< Slopes are looked at over this length. [Limit: 0.01 … 2]

  friend bool operator==(const SoftLimits&, const SoftLimits&) = default;
};

/// How good the ground is, cell by cell, row by row as the heights. Unknown cells have 0.
struct SoftGround {
  /// [1/255] That the vehicle cannot get over the cell's highest step down to a neighbour: the step
  /// is compared with the limit in the light of both cells' uncertainty, and the less sure the map
  /// is of the cell itself the less of an obstacle it is.
  std::vector<std::uint8_t> obstacle;
  /// [mm] From the cell to the mean of its four neighbours, at most 255: slopes have none.
  std::vector<std::uint8_t> roughness_mm;
  /// [1/100] Rise over the wheel base, uphill or downhill, within 4 % of it, at most 255.
  std::vector<std::uint8_t> slope_percent;
};

/// Requires: sigma_mm and wheel_base_m within their limits. Linear in the cells. `ground` may be
/// one of before, whose memory is then used again.
void assess(const HeightGrid& grid, const VehicleLimits& limits, const SoftLimits& soft,
            SoftGround& ground, const TerrainKernels& kernels = *usable_terrain_kernels().front());

/// assess() and classify() at once, in little more time than either.
void judge(const HeightGrid& grid, const VehicleLimits& limits, const SoftLimits& soft,
           std::vector<CellClass>& classes, SoftGround& ground,
           const TerrainKernels& kernels = *usable_terrain_kernels().front());

}  // namespace cairn
