#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/planner/trulla.h"

namespace cairn {

/// √2 and 0.705 in 1/65536.
inline constexpr std::uint32_t kDiagonal16 = 92682;
inline constexpr std::int32_t kWidestGap16 = 46203;

/// [cost units] From a cell of this price to the middle of its diagonal neighbour.
[[nodiscard]] inline std::int32_t diagonal_units(std::int32_t price) {
  return static_cast<std::int32_t>((static_cast<std::uint32_t>(price) * kDiagonal16 + 0x8000U) >>
                                   16);
}

/// Where the next cell's cost lies further than this above the diagonal one's, the straight
/// diagonal is best: 0.705 · price. (It is from √½ on; up to there the two differ by nothing.)
[[nodiscard]] inline std::int32_t widest_gap(std::int32_t price) {
  return (price * kWidestGap16) >> 16;
}

/// [cost units] Cost of the best straight way from the middle of a cell to the line between the
/// middles of its axial neighbour, whose cost is `gap` higher, and of the diagonal one beside it,
/// taken relative to the axial neighbour's cost: √(price² - gap²), rounded.
///
/// Falls with a growing gap, and by at most 1 per unit: so what is driven never gets cheaper when a
/// neighbour gets dearer, rounding included, which makes the field unique. The arithmetic of IEEE
/// 754 rounds alike on every machine. Requires: 0 ≤ gap ≤ widest_gap(price), price < 2^15.
[[nodiscard]] inline std::int32_t straight_units(std::int32_t price, std::int32_t gap) {
  const auto p = static_cast<float>(price);
  const auto g = static_cast<float>(gap);
  constexpr float kHalf = 0.5F;  // To nearest, as the vectorised twins do: never below 0.
  return static_cast<std::int32_t>(std::sqrt((p - g) * (p + g)) + kHalf);
}

/// [cost units] The best way through the triangle of a cell of this price with its axial
/// neighbour, from where it costs `axial` on, and the diagonal one.
[[nodiscard]] inline std::int32_t through_triangle(std::int32_t axial, std::int32_t diagonal,
                                                   std::int32_t price) {
  const std::int32_t gap = std::clamp(axial - diagonal, 0, widest_gap(price));
  return std::min(axial + straight_units(price, gap), diagonal + diagonal_units(price));
}

/// [cost units] No way out of a cell costs less than this more than where it leads.
inline constexpr std::int32_t kLeastUnits = 690;

/// The cost of what a cell's eight neighbours offer, each with the step to it: east first,
/// counter-clockwise. From kClosed on it offers nothing.
struct Offers {
  std::int32_t cost[8];
};

/// Diagonals around the corner of a closed cell (see Field::kClosed) are closed.
inline void close_corners(Offers& offers, const std::int32_t (&neighbour)[8]) {
  for (int d = 1; d < 8; d += 2) {
    const std::int32_t beside = std::max(neighbour[d - 1], neighbour[(d + 1) & 7]);
    offers.cost[d] = beside < Field::kClosed ? offers.cost[d] : Field::kClosed;
  }
}

/// What is around an even cell. Both pointers at the cell.
[[nodiscard]] inline Offers offers_around(const std::int32_t* levelled, const std::int32_t* lift,
                                          std::ptrdiff_t stride) {
  const std::ptrdiff_t step[8] = {1,  stride + 1,  stride,  stride - 1,
                                  -1, -stride - 1, -stride, -stride + 1};
  std::int32_t neighbour[8];
  Offers offers;
  for (int d = 0; d < 8; ++d) {
    neighbour[d] = levelled[step[d]];
    offers.cost[d] = neighbour[d] + std::abs(lift[step[d]] - lift[0]);
  }
  close_corners(offers, neighbour);
  return offers;
}

/// The best of the eight triangles; kUnreached or more when there is none.
[[nodiscard]] inline std::int32_t best_of(const Offers& offers, std::int32_t price) {
  std::int32_t best = Field::kClosed;
  for (int d = 0; d < 8; d += 2) {
    const std::int32_t axial = offers.cost[d];
    const std::int32_t diagonal = std::min(offers.cost[d + 1], offers.cost[(d + 7) & 7]);
    if (std::min(axial, diagonal) + kLeastUnits >= best) continue;
    best = std::min(best, through_triangle(axial, diagonal, price));
  }
  return best;
}

}  // namespace cairn
