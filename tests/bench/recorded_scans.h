#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/common/result.h"
#include "core/map/height_map.h"
#include "core/sensor/laser.h"

namespace cairn::bench {

/// One sweep as it lies in the site, placed by the true pose.
struct PlacedScan {
  std::size_t laser = 0;
  std::vector<Beam> beams;
};

/// Drives a simulated ATRV-Jr for `laps` laps around the furnished middle of the 13 × 13 m room
/// (T4.3.3) and returns what its lasers saw. The same seed gives the same scans.
[[nodiscard]] Result<std::vector<PlacedScan>> scans_of_room_laps(int laps, std::uint64_t seed);

/// The scans that, integrated one after the other, make the map of the room.
[[nodiscard]] HeightMap map_of(const std::vector<PlacedScan>& scans, int cell_size_mm);

}  // namespace cairn::bench
