#include "core/map/soft_ground.h"

namespace cairn {

namespace {

/// [cells] More answers than caches hold.
constexpr std::size_t kManyCells = std::size_t{1} << 22;

TerrainAnswers answers_in(SoftGround& ground, std::size_t cells) {
  ground.obstacle.resize(cells);
  ground.roughness_mm.resize(cells);
  ground.slope_percent.resize(cells);
  return {nullptr, ground.obstacle.data(), ground.roughness_mm.data(), ground.slope_percent.data(),
          cells >= kManyCells};
}

}  // namespace

void assess(const HeightGrid& grid, const VehicleLimits& limits, const SoftLimits& soft,
            SoftGround& ground, const TerrainKernels& kernels) {
  judge_terrain(grid, terrain_rules(grid.cell_size_mm, limits, soft),
                answers_in(ground, grid.height_mm.size()), kernels);
}

void judge(const HeightGrid& grid, const VehicleLimits& limits, const SoftLimits& soft,
           std::vector<CellClass>& classes, SoftGround& ground, const TerrainKernels& kernels) {
  TerrainAnswers answers = answers_in(ground, grid.height_mm.size());
  classes.resize(grid.height_mm.size());
  answers.classes = classes.data();
  judge_terrain(grid, terrain_rules(grid.cell_size_mm, limits, soft), answers, kernels);
}

}  // namespace cairn
