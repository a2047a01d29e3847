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
};

[[nodiscard]] DrivableGrid make_drivable(HeightGrid heights, const PlannerConfig& config);

/// Steps to the eight neighbours, counter-clockwise from east: E NE N NW W SW S SE.
inline constexpr int kStepX[8] = {1, 1, 0, -1, -1, -1, 0, 1};
inline constexpr int kStepY[8] = {0, 1, 1, 1, 0, -1, -1, -1};

/// [1e-4 m of level driving] to drive one step from cell `from` to its neighbour in `direction`, or
/// kNoWay: the neighbour is closed or outside, a diagonal would cut the corner of a closed cell,
/// or the height step is beyond the limits in this direction. Climbing and descending differ.
/// `from` itself need not be open (a robot may have to leave a tight place).
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
  std::vector<std::uint32_t> cost;     ///< [1e-4 m of level driving]; kNoWay = not reachable.
  std::vector<std::uint8_t> direction;  ///< 0 … 7, kAtGoal or kNoDirection.

  static constexpr std::uint8_t kAtGoal = 8;
  static constexpr std::uint8_t kNoDirection = 255;
};

/// Radiates from the goal over all that is reachable; the most desirable way to a cell wins.
/// invalid_argument when the goal is outside the grid or closed (the message says which).
[[nodiscard]] Result<Field> compute_field(const DrivableGrid& grid, CellIndex goal,
                                          const PlannerConfig& config);

}  // namespace cairn
