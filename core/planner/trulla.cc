#include "core/planner/trulla.h"

#include "core/planner/tile_wave.h"

namespace cairn {

Result<Field> compute_field(const DrivableGrid& grid, CellIndex goal) {
  if (const std::string why = why_closed(grid, goal); !why.empty()) {
    return Error{ErrorCode::invalid_argument, "the goal " + why};
  }
  Field field = unreached_field(grid, goal);
  TileWave(grid, field, *usable_field_kernels().front()).radiate();
  return field;
}

}  // namespace cairn
