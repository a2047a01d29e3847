#pragma once

#include <cstdint>
#include <vector>

#include "core/planner/trulla.h"

namespace cairn {

/// A map cell's new value.
struct CellChange {
  CellIndex cell;
  std::int32_t height_mm = 0;
  std::uint8_t probability = 0;  ///< 0 = unknown.
};

/// A field that follows its map: when cells change only what depends on them is computed again, and
/// afterwards the grid and the field equal those of a new plan exactly, whether ways were closed or
/// opened (which T2.2.4 leaves as it was once marked).
/// Not thread-safe.
class FieldKeeper {
 public:
  /// invalid_argument when the goal is outside or closed.
  /// Requires: the grid was made with the config.
  [[nodiscard]] static Result<FieldKeeper> create(DrivableGrid grid, const PlannerConfig& config,
                                                  CellIndex goal);

  /// Takes over new values; cells outside the grid are left out. A goal that gets closed is reached
  /// from nowhere until it opens again.
  void change(const std::vector<CellChange>& changes);

  [[nodiscard]] const DrivableGrid& grid() const { return grid_; }
  [[nodiscard]] const Field& field() const { return field_; }
  /// [bytes] Of the grid, the field and its work space.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  FieldKeeper(DrivableGrid grid, const PlannerConfig& config, Field field);

  /// Classes, what is open and what it costs around the changed box; what differs then.
  /// Requires: the heights are those after all changes, in whatever box.
  [[nodiscard]] std::vector<std::uint32_t> convert(const GridBox& changed);
  void convert_open(const GridBox& box, const GridBox& around);
  void start_anew();
  void repair(const std::vector<std::uint32_t>& cells);

  DrivableGrid grid_;
  PlannerConfig config_;
  Field field_;
  std::vector<std::uint8_t> doubted_;  ///< Work space of the wave; all 0.
};

}  // namespace cairn
