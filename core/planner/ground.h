#pragma once

#include "core/planner/stencil.h"

namespace cairn {

/// Reads what a grid's ground and a field on it say about single cells.
class GroundReader {
 public:
  explicit GroundReader(const DrivableGrid& grid) : grid_(grid), ground_(grid.ground) {}

  [[nodiscard]] std::ptrdiff_t stride() const { return ground_.stride; }
  [[nodiscard]] bool closed(std::size_t cell) const { return ground_.price[cell] == 0; }
  [[nodiscard]] std::int32_t price(std::size_t cell) const {
    return ground_.price[cell] & PricedGround::kPriceMask;
  }

  /// [cost units, levelled] What a cell costs by its neighbours; kUnreached or more: no way.
  /// Requires: !closed(cell).
  [[nodiscard]] std::int32_t cost_by_neighbours(const std::int32_t* levelled,
                                                std::size_t cell) const {
    return best_of(offers(levelled, cell), price(cell));
  }
  /// What the neighbours offer, in levelled costs of this cell.
  [[nodiscard]] Offers offers(const std::int32_t* levelled, std::size_t cell) const {
    if ((ground_.price[cell] & PricedGround::kUneven) != 0) return uneven(levelled, cell);
    return offers_around(levelled + cell, ground_.lift.data() + cell, stride());
  }
  /// [cost units] Levelled costs come out of the step in `direction` this much higher, or kClosed:
  /// the step is beyond the limits. Requires: both cells are open.
  [[nodiscard]] std::int32_t effort(std::size_t from, int direction) const;

  [[nodiscard]] std::ptrdiff_t step(int direction) const {
    return kStepX[direction] + kStepY[direction] * stride();
  }

 private:
  [[nodiscard]] Offers uneven(const std::int32_t* levelled, std::size_t cell) const;
  /// Where the cell lies in the heights.
  [[nodiscard]] std::size_t height_at(std::size_t cell) const {
    const auto stride = static_cast<std::size_t>(ground_.stride);
    return (cell / stride - 1) * (stride - 1) + cell % stride - 1;
  }

  const DrivableGrid& grid_;
  const PricedGround& ground_;
};

/// A field of this grid that nothing has reached yet: kUnreached where it is open.
[[nodiscard]] Field unreached_field(const DrivableGrid& grid, CellIndex goal);

}  // namespace cairn
