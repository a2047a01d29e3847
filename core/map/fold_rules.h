#pragma once

#include <array>
#include <cstdint>

#include "core/map/cell.h"
#include "core/map/sensor_model.h"

namespace cairn {

/// What a submap's evidence makes of one cell of the long-term map (fold.h); all heights are in the
/// same frame. First `after_seen_through`, then `after_surface`.
class FoldRules {
 public:
  /// Requires: a sound model.
  explicit FoldRules(const SensorModel& model);

  /// The stored cell after a beam was seen to pass at the height of `seen`.
  [[nodiscard]] Cell after_seen_through(const Cell& cell, const Cell& seen) const;
  [[nodiscard]] Cell after_surface(const Cell& cell, const Cell& surface) const;

 private:
  [[nodiscard]] Cell believed(std::int32_t height_mm, std::uint8_t probability) const;

  SensorModel model_;
  std::array<int, 256> hits_{};
};

}  // namespace cairn
