#include "core/planner/trulla.h"

#include <algorithm>
#include <iterator>

#include "core/planner/tile_wave.h"
#include "core/planner/wave.h"

namespace cairn {
namespace {

/// In tiles a cell with rules of its own takes about 40 times as long as another, and three times
/// as long as in a wave: beyond one in so many the wave is quicker.
constexpr std::ptrdiff_t kUnevenForWave = 6;

bool mostly_uneven(const PricedGround& ground) {
  if (!ground.uneven) return false;
  const auto uneven = std::count_if(ground.price.begin(), ground.price.end(), [](std::uint16_t p) {
    return (p & PricedGround::kUneven) != 0;
  });
  return uneven * kUnevenForWave > std::ssize(ground.price);
}

}  // namespace

void radiate(const DrivableGrid& grid, Field& field) {
  if (mostly_uneven(grid.ground)) {
    Wave(grid, field).radiate();
  } else {
    TileWave(grid, field, *usable_field_kernels().front()).radiate();
  }
}

Result<Field> compute_field(const DrivableGrid& grid, CellIndex goal) {
  if (const std::string why = why_closed(grid, goal); !why.empty()) {
    return Error{ErrorCode::invalid_argument, "the goal " + why};
  }
  Field field = unreached_field(grid, goal);
  radiate(grid, field);
  return field;
}

}  // namespace cairn
