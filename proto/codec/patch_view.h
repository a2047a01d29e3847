#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/map/cell.h"

namespace cairn::proto {

/// Where a robot was when it wrote a patch, in the submap's grid: what changed lies around it as
/// its sensors do. It only lends contexts.
struct Viewpoint {
  CellIndex at;
  std::uint8_t heading = 0;  ///< [1/64 turn] From the grid's x towards its y. [Limit: < 64]
  friend bool operator==(const Viewpoint&, const Viewpoint&) = default;
};
inline constexpr int kHeadings = 64;

/// The heading nearest to an angle [rad].
[[nodiscard]] std::uint8_t heading_of(double yaw_rad);

namespace patch {

/// A cell's place as seen from the viewpoint, in classes.
struct Place {
  static constexpr std::size_t kDistances = 40;
  static constexpr std::size_t kAhead = 32;
  static constexpr std::size_t kAside = 12;
  static constexpr std::size_t kOctants = 8;

  std::size_t distance = 0;  ///< Two for each factor of 1.41.
  std::size_t ahead = 0;     ///< In steps of four cells, 48 cells behind and more being 0.
  std::size_t aside = 0;     ///< In steps of eight cells, to either side.
  std::size_t octant = 0;

  [[nodiscard]] std::size_t polar() const { return distance * kOctants + octant; }
  [[nodiscard]] std::size_t square() const { return ahead * kAside + aside; }
};

[[nodiscard]] Place place_from(const Viewpoint& view, std::int64_t x, std::int64_t y);

}  // namespace patch
}  // namespace cairn::proto
