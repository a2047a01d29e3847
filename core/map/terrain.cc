#include <algorithm>
#include <cmath>

#include "core/map/soft_ground.h"
#include "core/map/terrain_kernels.h"

namespace cairn {
namespace {

constexpr double kInt16 = 32768.0;

std::int32_t rounded(double value) { return static_cast<std::int32_t>(std::lround(value)); }

/// The farthest that a number not above `highest` may be shifted up within 16 bits.
int room_above(std::int32_t highest) {
  int shift = 0;
  while (highest << (shift + 1) < static_cast<std::int32_t>(kInt16)) ++shift;
  return shift;
}

void set_obstacle_rule(TerrainRules& rules, double sigma_mm) {
  // Two sigmas of a difference; see BlockJudge::obstacle_part. The share of 2 · widest that a step
  // goes beyond the limit, half of that for the least sure:
  //   beyond · (255 + p) / (2 · 255) / (2 · spread), with beyond shifted and (255 + p) times 64.
  const double spread_mm = 2.83 * sigma_mm;
  rules.widest_mm = static_cast<std::int32_t>(std::ceil(2.0 * spread_mm));
  rules.widest_shift = room_above(rules.widest_mm);
  const double shifted = spread_mm * (1 << rules.widest_shift);
  rules.sureness = rounded(8192.0 * kInt16 * kInt16 / (64.0 * 1020.0 * shifted));
}

void set_slope_rule(TerrainRules& rules, int cell_size_mm) {
  const double base_mm = 2.0 * rules.reach * cell_size_mm;
  rules.steepest_mm = static_cast<std::int32_t>(std::min(std::ceil(2.75 * base_mm), 30000.0));
  rules.steepest_shift = room_above(rules.steepest_mm);
  const double percent = 100.0 * kInt16 / (base_mm * (1 << rules.steepest_shift));
  rules.along = rounded(percent * 61 / 64);
  rules.across = rounded(percent * 25 / 64);
}

}  // namespace

TerrainRules terrain_rules(int cell_size_mm, const VehicleLimits& limits, const SoftLimits& soft) {
  TerrainRules rules;
  rules.limit_mm =
      std::clamp(std::max(limits.climb_mm, limits.descend_mm), 0, TerrainRules::kHighestLimitMm);
  rules.reach =
      std::clamp(static_cast<int>(std::lround(soft.wheel_base_m * 500 / cell_size_mm)), 1, 64);
  set_obstacle_rule(rules, soft.sigma_mm);
  set_slope_rule(rules, cell_size_mm);
  return rules;
}

namespace {

/// [rows] Judged in 32 bits before 16 are tried again.
constexpr int kTallRows = 16;

void judge_strip(TerrainBlock strip, const TerrainKernels& kernels, TerrainScratch& scratch) {
  const int end = strip.south + strip.height;
  while (strip.south < end) {
    strip.height = end - strip.south;
    int judged = kernels.judge(strip, scratch);
    if (judged == 0) {
      strip.height = std::min(strip.height, kTallRows);
      judged = portable_terrain_kernels().judge(strip, scratch);
    }
    strip.south += judged;
  }
}

}  // namespace

void judge_terrain(const HeightGrid& grid, const TerrainRules& rules, const TerrainAnswers& answers,
                   const TerrainKernels& kernels) {
  const bool tall = rules.limit_mm > TerrainRules::kHighest16BitLimitMm;
  const TerrainKernels& suited = tall ? portable_terrain_kernels() : kernels;
  TerrainScratch scratch;
  for (int x = 0; x < grid.width; x += TerrainBlock::kMostWidth) {
    const int width = std::min(TerrainBlock::kMostWidth, grid.width - x);
    judge_strip({grid, rules, answers, x, 0, width, grid.height}, suited, scratch);
  }
}

}  // namespace cairn
