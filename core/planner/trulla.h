#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/map/traversability.h"

namespace cairn {

/// How ground that nobody has seen is planned over (T4.3.2).
enum class UnknownGround : std::uint8_t {
  blocked,  ///< Never: it might hide a drop.
  allowed,  ///< At `unknown_price` times the distance.
};

/// What makes one way better than another. Effort is in metres of level driving.
struct PlannerConfig {
  VehicleLimits limits;
  UnknownGround unknown = UnknownGround::blocked;
  double unknown_price = 3.0;   ///< [m/m] Cost of unknown ground per metre. [Limit: 1 … 100]
  double climb_effort = 8.0;    ///< [m/m] Extra cost per metre of height gained. [Limit: 0 … 100]
  double descend_effort = 2.0;  ///< [m/m] Extra cost per metre of height lost. [Limit: 0 … 100]

  friend bool operator==(const PlannerConfig&, const PlannerConfig&) = default;
};

/// Every fault in one sentence each, joined by "; ". Empty when it is sound.
[[nodiscard]] std::string faults(const PlannerConfig& config);

/// Where a vehicle's centre may be. Row by row as the grid it was made from.
struct DrivableGrid {
  HeightGrid heights;
  std::vector<CellClass> classes;
  /// The centre may be here: not an obstacle, no obstacle's middle nearer than the vehicle's
  /// radius (exact Euclidean distance between cell middles), and known unless unknown is allowed.
  std::vector<std::uint8_t> open;
  VehicleLimits limits;  ///< Of the vehicle that `classes` and `open` hold for.
};

/// Time and memory grow with the number of cells, not with the radius.
/// Requires: faults(config).empty().
[[nodiscard]] DrivableGrid make_drivable(HeightGrid heights, const PlannerConfig& config);

/// Why the vehicle's centre cannot be at `cell`, to follow "the goal ": "lies outside the map", "is
/// on an obstacle", … Empty when it can.
[[nodiscard]] std::string why_closed(const DrivableGrid& grid, CellIndex cell);

/// Steps to the eight neighbours, counter-clockwise from east: E NE N NW W SW S SE.
inline constexpr int kStepX[8] = {1, 1, 0, -1, -1, -1, 0, 1};
inline constexpr int kStepY[8] = {0, 1, 1, 1, 0, -1, -1, -1};

/// [1e-4 m of level driving] to drive one step from cell `from` to its neighbour in `direction`, or
/// kNoWay: the neighbour is closed or outside, a diagonal would cut the corner of a closed cell,
/// or the height step is beyond the limits in this direction. Climbing and descending differ.
/// `from` itself need not be open (a robot may have to leave a tight place).
///
/// The cost is the step's length, round(cell_mm · 10) or round(cell_mm · 10 · √2), each half priced
/// by the cell it lies in: 1 on known ground, `unknown_price` on unknown. Between two known cells
/// comes |dz| · climb_effort or |dz| · descend_effort on top; next to an unknown cell no effort and
/// no limit of height applies. Price and efforts are rounded to 1/1000, length and effort of the
/// step to 1e-4 m, so costs are whole numbers and the same on every machine.
/// A single step that costs kNoWay or more is kNoWay.
[[nodiscard]] std::uint32_t step_cost(const DrivableGrid& grid, const PlannerConfig& config,
                                      std::size_t from, int direction);
inline constexpr std::uint32_t kNoWay = std::numeric_limits<std::uint32_t>::max();

/// Trulla's field (T2.2.4): for every cell from which the goal can be reached the cost to get
/// there and the step to take first.
struct Field {
  CellIndex origin;
  int width = 0;
  int height = 0;
  CellIndex goal;
  /// [1e-4 m of level driving]; kNoWay = not reachable. Closed cells have no cost, though one may
  /// step out of them. Ways of 429 km of level driving and more count as not reachable.
  std::vector<std::uint32_t> cost;
  std::vector<std::uint8_t> direction;  ///< 0 … 7, kAtGoal or kNoDirection.

  static constexpr std::uint8_t kAtGoal = 8;
  static constexpr std::uint8_t kNoDirection = 255;
};

/// Radiates from the goal over all that is reachable; the most desirable way to a cell wins (of
/// equals, the first in the order of directions: the field depends on the grid alone). Costs are
/// those of step_cost, driven *towards* the goal. Linear in the number of cells while no step costs
/// more than about 250 steps on level ground.
/// invalid_argument when the goal is outside the grid or closed (the message says which).
/// Requires: faults(config).empty(), grid made with the same config.
[[nodiscard]] Result<Field> compute_field(const DrivableGrid& grid, CellIndex goal,
                                          const PlannerConfig& config);

}  // namespace cairn
