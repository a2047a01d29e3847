#include "client/map_files/passable.h"

#include <algorithm>

namespace cairn::map_files {

namespace {

/// Visits the eight neighbours that lie in the raster.
template <class Visit>
void around(const RasterFrame& frame, std::size_t cell, Visit&& visit) {
  const int column = static_cast<int>(cell % static_cast<std::size_t>(frame.columns));
  const int row = static_cast<int>(cell / static_cast<std::size_t>(frame.columns));
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, frame.rows - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, frame.columns - 1); ++x) {
      if (x != column || y != row) visit(frame.at(x, y));
    }
  }
}

}  // namespace

Result<Relief> relief_of(const ClassRaster& classes) {
  const RasterFrame& frame = classes.frame;
  Relief relief{{frame, std::vector<std::int32_t>(frame.cells(), HeightRaster::kUnknown)}, 0};
  std::vector<std::int32_t>& height_mm = relief.raster.height_mm;
  std::vector<std::uint32_t> front;
  // Obstacles beside free ground first, then those beside these, and so on.
  for (std::size_t cell = 0; cell < frame.cells(); ++cell) {
    if (classes.classes[cell] == CellClass::free) {
      height_mm[cell] = 0;
    } else if (classes.classes[cell] == CellClass::obstacle) {
      ++relief.lone_obstacles;
      bool beside_free = false;
      around(frame, cell,
             [&](std::size_t near) { beside_free |= classes.classes[near] == CellClass::free; });
      if (beside_free) front.push_back(static_cast<std::uint32_t>(cell));
    }
  }
  if (std::ranges::find(classes.classes, CellClass::free) == classes.classes.end()) {
    return Error{ErrorCode::invalid_argument,
                 "has no free cell: there is nothing that a robot could stand on"};
  }
  for (const std::uint32_t cell : front) height_mm[cell] = kObstacleMm;
  while (!front.empty()) {
    relief.lone_obstacles -= static_cast<std::int64_t>(front.size());
    std::vector<std::uint32_t> next;
    for (const std::uint32_t cell : front) {
      around(frame, cell, [&](std::size_t near) {
        const bool waits = classes.classes[near] == CellClass::obstacle &&
                           height_mm[near] == HeightRaster::kUnknown;
        if (!waits) return;
        height_mm[near] = height_mm[cell] + kRiseMm;
        next.push_back(static_cast<std::uint32_t>(near));
      });
    }
    front = std::move(next);
  }
  return relief;
}

}  // namespace cairn::map_files
