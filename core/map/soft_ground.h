#pragma once

#include <cstdint>
#include <string>
#include <vector>

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

/// The row kernels in one instruction set. All give the same integers.
struct SoftKernels {
  const char* name;
  void (*row)(const struct SoftRow& row);
};

/// One row of the work. Heights have room for `margin` cells on either side; what is unknown or
/// outside is kNoHeight.
struct SoftRow {
  const std::int32_t* below;  ///< Row y - 1.
  const std::int32_t* own;
  const std::int32_t* above;   ///< Row y + 1.
  const std::int32_t* behind;  ///< Row y - reach.
  const std::int32_t* ahead;   ///< Row y + reach.
  const std::uint8_t* probability;
  int width;
  int reach;  ///< [cells] Half a wheel base.
  std::int32_t step_limit_mm;
  float sigma_mm;
  std::int32_t slope_scale;  ///< [1/4096] From mm over 2 · reach cells to percent.
  std::uint8_t* obstacle;
  std::uint8_t* roughness_mm;
  std::uint8_t* slope_percent;

  static constexpr std::int32_t kNoHeight = 0x7fffffff;
};

[[nodiscard]] const SoftKernels& portable_soft_kernels();
/// All that this processor can run, fastest first, the portable one last.
[[nodiscard]] const std::vector<const SoftKernels*>& usable_soft_kernels();
[[nodiscard]] const SoftKernels* avx2_soft_kernels();
[[nodiscard]] const SoftKernels* avx512_soft_kernels();

/// Requires: sigma_mm and wheel_base_m within their limits. Linear in the cells. `ground` may be
/// one of before, whose memory is then used again.
void assess(const HeightGrid& grid, const VehicleLimits& limits, const SoftLimits& soft,
            SoftGround& ground, const SoftKernels& kernels = *usable_soft_kernels().front());

}  // namespace cairn
