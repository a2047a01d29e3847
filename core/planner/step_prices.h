#pragma once

#include <cstdint>

#include "core/planner/trulla.h"

namespace cairn {

/// A planner's configuration in the whole numbers that steps are priced with (see step_cost).
class StepPrices {
 public:
  StepPrices(const PlannerConfig& config, int cell_size_mm);

  /// [1e-4 m] From one cell to its neighbour by heights and distance alone, not asking whether they
  /// are open; kNoWay when the height step is beyond the limits in this direction.
  [[nodiscard]] std::uint32_t between(const HeightGrid& grid, std::size_t from, std::size_t to,
                                      bool diagonal) const {
    const std::int64_t length = diagonal ? diagonal_ : axial_;
    if (grid.probability[from] == 0 || grid.probability[to] == 0) {
      return into_unknown(grid, from, to, length);
    }
    const std::int64_t rise_mm = std::int64_t{grid.height_mm[to]} - grid.height_mm[from];
    if (rise_mm > climb_mm_ || -rise_mm > descend_mm_) return kNoWay;
    // 1 mm is 10 units and efforts are in 1/1000: together 1/100.
    const std::int64_t effort = rise_mm > 0 ? rise_mm * climb_effort_ : -rise_mm * descend_effort_;
    return saturated(length + (effort + 50) / 100);
  }
  /// [1e-4 m] No step is cheaper.
  [[nodiscard]] std::uint32_t cheapest() const { return saturated(axial_); }

 private:
  [[nodiscard]] static std::uint32_t saturated(std::int64_t cost) {
    return cost < std::int64_t{kNoWay} ? static_cast<std::uint32_t>(cost) : kNoWay;
  }
  [[nodiscard]] std::uint32_t into_unknown(const HeightGrid& grid, std::size_t from, std::size_t to,
                                           std::int64_t length) const {
    const std::int64_t both_halves = (grid.probability[from] == 0 ? unknown_price_ : 1000) +
                                     (grid.probability[to] == 0 ? unknown_price_ : 1000);
    return saturated((both_halves * length + 1000) / 2000);
  }

  std::int64_t axial_;           ///< [1e-4 m]
  std::int64_t diagonal_;        ///< [1e-4 m]
  std::int64_t unknown_price_;   ///< [1/1000]
  std::int64_t climb_effort_;    ///< [1/1000]
  std::int64_t descend_effort_;  ///< [1/1000]
  std::int64_t climb_mm_;
  std::int64_t descend_mm_;
};

}  // namespace cairn
