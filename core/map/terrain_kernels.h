#pragma once

#include <cstdint>
#include <vector>

#include "core/map/traversability.h"

namespace cairn {

struct SoftLimits;

/// What cells are judged by, as the kernels want it: whole numbers of 16 bits.
struct TerrainRules {
  static constexpr std::int32_t kHighestLimitMm = 1 << 29;
  /// Higher limits are for 32 bits; so are heights that lie farther apart than 32 m.
  static constexpr std::int32_t kHighest16BitLimitMm = 16383;

  std::int32_t limit_mm = 0;  ///< 0 … kHighestLimitMm.
  int reach = 1;              ///< [cells] Half a wheel base, 1 … 64.

  // Obstacle probability: the beyond-the-limit part of a step, cut off at ±widest_mm, shifted up by
  // its shift, times sureness times 2^-15 is a share of 2^-13.
  std::int32_t widest_mm = 0;
  int widest_shift = 0;
  std::int32_t sureness = 0;

  // Slope: a difference in height over 2 · reach cells, cut off at steepest_mm and shifted up,
  // times along (the larger of two) and across (the smaller) times 2^-15 are percents.
  std::int32_t steepest_mm = 0;
  int steepest_shift = 0;
  std::int32_t along = 0;
  std::int32_t across = 0;
};

/// Requires: limits within theirs.
[[nodiscard]] TerrainRules terrain_rules(int cell_size_mm, const VehicleLimits& limits,
                                         const SoftLimits& soft);

/// Where the answers go, for the whole grid. Classes, or the three others, may be null: not wanted.
struct TerrainAnswers {
  CellClass* classes = nullptr;
  std::uint8_t* obstacle = nullptr;
  std::uint8_t* roughness_mm = nullptr;
  std::uint8_t* slope_percent = nullptr;
  /// More than a cache holds: written past it.
  bool streamed = false;
};

/// A part of the work. Blocks do not depend on each other.
struct TerrainBlock {
  const HeightGrid& grid;
  const TerrainRules& rules;
  const TerrainAnswers& answers;
  int west = 0;  ///< [cells] In the grid: from here, so many.
  int south = 0;
  int width = 0;
  int height = 0;

  static constexpr int kMostWidth = 4096;
};

/// What the work on one block leaves for the next.
struct TerrainScratch {
  std::vector<std::uint8_t> memory;
  std::int32_t level_mm = 0;  ///< That the last block's heights were told from.
};

/// The work in one instruction set. All give the same answers.
struct TerrainKernels {
  const char* name;
  /// Judges a block's rows, from the south, and says how many: all, or those before heights that
  /// are too far apart for 16 bits; with the portable kernels all.
  int (*judge)(const TerrainBlock& block, TerrainScratch& scratch);
};

[[nodiscard]] const TerrainKernels& portable_terrain_kernels();
/// All that this processor can run, fastest first, the portable ones last.
[[nodiscard]] const std::vector<const TerrainKernels*>& usable_terrain_kernels();
[[nodiscard]] const TerrainKernels* avx2_terrain_kernels();
[[nodiscard]] const TerrainKernels* avx512_terrain_kernels();

/// Block by block.
void judge_terrain(const HeightGrid& grid, const TerrainRules& rules, const TerrainAnswers& answers,
                   const TerrainKernels& kernels);

}  // namespace cairn
