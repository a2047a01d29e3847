#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/map/soft_ground.h"

namespace cairn {

/// How ground that nobody has seen is planned over (T4.3.2).
enum class UnknownGround : std::uint8_t {
  blocked,  ///< Never: it might hide a drop.
  allowed,  ///< At `unknown_price` times the distance.
  explore,  ///< Never, but a plan that finds no way tells which frontier might open one.
};

/// What makes one way better than another. Effort is in metres of level driving.
struct PlannerConfig {
  VehicleLimits limits;
  UnknownGround unknown = UnknownGround::blocked;
  double unknown_price = 3.0;   ///< [m/m] Cost of unknown ground per metre. [Limit: 1 … 30]
  double climb_effort = 8.0;    ///< [m/m] Extra cost per metre of height gained. [Limit: 0 … 100]
  double descend_effort = 2.0;  ///< [m/m] Extra cost per metre of height lost. [Limit: 0 … 100]
  SoftLimits soft;
  /// [m/m] Extra cost per metre of ground that is surely an obstacle; of less sure ground by its
  /// probability (T5.3). [Limit: 0 … 30]
  double obstacle_price = 0.0;
  double roughness_price = 0.0;  ///< [m/m] Extra, per 100 mm of roughness. [Limit: 0 … 30]
  double slope_price = 0.0;      ///< [m/m] Extra, on a slope of 100 %. [Limit: 0 … 30]
  double closeness_price = 0.0;  ///< [m/m] Extra, right at the radius. [Limit: 0 … 30]
  double closeness_m = 0.5;      ///< Where it ends, beyond the radius. [Limit: 0.01 … 5]

  friend bool operator==(const PlannerConfig&, const PlannerConfig&) = default;
};

/// Every fault in one sentence each, joined by "; ". Empty when it is sound.
[[nodiscard]] std::string faults(const PlannerConfig& config);

/// What driving costs, cell by cell, in whole numbers: computed once, read by every step of a wave.
/// Rows are one cell longer than the map and there is one more below and above it, so that every
/// cell has eight neighbours; those outside are closed.
///
/// Climbing and descending differ, and yet the waves may treat both alike: with effort c per metre
/// up and d per metre down a step costs (c + d)/2 · |dz| + (c - d)/2 · dz, and the second part adds
/// up to the same over every way between two cells. `lift` carries the first part; the second is
/// charged once, at the end (see cost_to_goal).
struct PricedGround {
  int stride = 0;
  /// [cost units] Steps cost their difference, either way. 0 at height 0 of the site; counted up to
  /// 2^28, with the usual efforts seven kilometres on cells of 125 mm.
  std::vector<std::int32_t> lift;
  std::vector<std::uint16_t> price;  ///< [cost units] To cross the cell; 0 = closed. See kUneven.
  /// One bit per cell that is open, 64 columns to a word; see open_word.
  std::vector<std::uint64_t> open_bits;
  double one_way = 0.0;  ///< (c - d) / (c + d)
  bool uneven = false;   ///< Some price may be kUneven.
  /// Of each tile of kTile × kTile cells the price of all its open cells, which steps between them
  /// and to those around do not add to; 0 where it is not that simple. Row by row.
  std::vector<std::uint16_t> level_price;
  bool uniform = false;  ///< Every tile has the same.

  static constexpr int kTile = 64;

  /// Set in a price: steps to some neighbour have rules of their own (unknown ground next to known
  /// ground, a step that the vehicle manages one way only).
  static constexpr std::uint16_t kUneven = 0x8000;
  static constexpr std::uint16_t kPriceMask = 0x7fff;

  /// Of the cell at column x and row y, both from -1 on.
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(stride) +
           static_cast<std::size_t>(x + 1);
  }
  /// Where the bits of columns 64 · word to 64 · word + 63 of a row are, both from -1 on.
  [[nodiscard]] std::size_t open_word(int word, int y) const {
    const int words = (stride + 62) / 64 + 2;
    return static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(words) +
           static_cast<std::size_t>(word + 1);
  }
  /// [cost units] The second part above, from lift 0 up to this cell.
  [[nodiscard]] std::int32_t one_way_effort(std::size_t cell) const {
    return static_cast<std::int32_t>(std::floor(lift[cell] * one_way));
  }
};

/// What an operator adds to the price of a grid's cells, row by row, in 1/16 of level ground;
/// empty: nothing.
using WeightLayer = std::vector<std::uint8_t>;

/// Costs are whole numbers of the 985th part of one level cell's length, the same on every machine.
/// 985 because its diagonal is 1393 to the seventh digit.
inline constexpr std::int32_t kCellUnits = 985;

/// Where a vehicle's centre may be and what it costs to be there. `classes` and `open` row by row
/// as the heights.
struct DrivableGrid {
  HeightGrid heights;
  std::vector<CellClass> classes;
  /// The centre may be here: not an obstacle, no obstacle's middle nearer than the vehicle's
  /// radius (exact Euclidean distance between cell middles), and known unless unknown is allowed.
  std::vector<std::uint8_t> open;
  VehicleLimits limits;  ///< Of the vehicle that `classes` and `open` hold for.
  PricedGround ground;
  WeightLayer weights;
  /// [cost units] What cells cost to cross when open, with all that makes ground dearer; empty:
  /// nothing does.
  std::vector<std::uint16_t> soft_price;

  /// [m] One unit of cost.
  [[nodiscard]] double unit_m() const { return heights.cell_size_mm / 1000.0 / kCellUnits; }
  /// Where a cell lies in `ground` and in a field. Requires: heights.contains(cell).
  [[nodiscard]] std::size_t ground_at(CellIndex cell) const {
    return ground.at(cell.x - heights.origin.x, cell.y - heights.origin.y);
  }
};

/// Time and memory grow with the number of cells, not with the radius.
/// Nothing is dearer than 33 times level ground. Requires: faults(config).empty(), weights empty or
/// one per cell.
[[nodiscard]] DrivableGrid make_drivable(HeightGrid heights, const PlannerConfig& config,
                                         WeightLayer weights = {});

/// [cells] How far a change of a height changes what cells cost: no cell farther away in x or y.
[[nodiscard]] int reach_of_change(const DrivableGrid& grid, const PlannerConfig& config);

/// Fills in `soft_price` from the heights, classes and weights.
void price_softly(DrivableGrid& grid, const PlannerConfig& config);

/// Part of a grid: columns and rows from the lowest to the highest, counted from its origin.
struct GridBox {
  int x0 = 0;
  int y0 = 0;
  int x1 = -1;
  int y1 = -1;

  [[nodiscard]] bool empty() const { return x1 < x0 || y1 < y0; }
};

/// Computes `ground` anew inside the box, from the heights and what is open in and around it.
/// Requires: the box lies in the grid.
void price_ground(DrivableGrid& grid, const PlannerConfig& config, const GridBox& box);

/// Why the vehicle's centre cannot be at `cell`, to follow "the goal ": "lies outside the map", "is
/// on an obstacle", … Empty when it can.
[[nodiscard]] std::string why_closed(const DrivableGrid& grid, CellIndex cell);

/// Steps to the eight neighbours, counter-clockwise from east: E NE N NW W SW S SE.
inline constexpr int kStepX[8] = {1, 1, 0, -1, -1, -1, 0, 1};
inline constexpr int kStepY[8] = {0, 1, 1, 1, 0, -1, -1, -1};

/// [cost units] To drive one step from cell `from` to its neighbour in `direction`, or kNoWay: one
/// of the two is closed or outside, a diagonal would cut the corner of a closed cell, or the height
/// step is beyond the limits in this direction. Climbing and descending differ.
///
/// The cost is the step's length times the price of the cell it leaves (1 on known ground,
/// `unknown_price` on unknown); between two known cells comes the effort of the height step on top:
/// climb_effort per metre up, descend_effort per metre down. Next to an unknown cell no effort and
/// no limit of height applies.
[[nodiscard]] std::uint32_t step_cost(const DrivableGrid& grid, CellIndex from, int direction);
inline constexpr std::uint32_t kNoWay = std::numeric_limits<std::uint32_t>::max();

/// Trulla's field (T2.2.4): for every cell from which the goal can be reached the cost to get
/// there, driving in any direction. Its value at a cell is the least of, for each of the eight
/// triangles that the cell forms with two neighbours side by side (one axial, one diagonal), the
/// cost of driving straight to the best point between the two plus the cost from there, linear
/// between theirs (Philippsen & Siegwart 2005; Ferguson & Stentz 2006). No triangle reaches around
/// the corner of a closed cell. As every value rests on lower ones alone, there is exactly one such
/// field, whatever the order of work.
struct Field {
  CellIndex origin;
  int width = 0;
  int height = 0;
  CellIndex goal;
  /// [cost units] In the layout of PricedGround, its one-way part left out; from kUnreached on
  /// there is no way to the goal, which is also said of ways of more than a million level cells.
  std::vector<std::int32_t> levelled;

  static constexpr std::int32_t kUnreached = 0x3fffffff;
  static constexpr std::int32_t kClosed = 0x40000000;
};

/// [cost units] From a cell to the field's goal; kNoWay where there is no way, also for cells
/// outside. The field must be of this grid.
[[nodiscard]] std::uint32_t cost_to_goal(const DrivableGrid& grid, const Field& field,
                                         CellIndex cell);

/// Radiates from the goal over all that is reachable.
/// invalid_argument when the goal is outside the grid or closed (the message says which).
/// Requires: grid made by make_drivable.
[[nodiscard]] Result<Field> compute_field(const DrivableGrid& grid, CellIndex goal);

}  // namespace cairn
