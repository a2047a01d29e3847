#include "core/planner/ground.h"

namespace cairn {
namespace {

/// [cost units] Lifts beyond are cut off: far more than any slope that a vehicle climbs adds up to.
constexpr double kHighestLift = 1 << 28;

/// Turns heights and classes into prices, row by row.
class Pricing {
 public:
  Pricing(DrivableGrid& grid, const PlannerConfig& config)
      : grid_(grid),
        ground_(grid.ground),
        units_per_mm_((config.climb_effort + config.descend_effort) / 2 * kCellUnits /
                      grid.heights.cell_size_mm),
        unknown_price_(static_cast<std::uint16_t>(std::lround(config.unknown_price * kCellUnits))),
        some_uneven_(config.unknown == UnknownGround::allowed ||
                     config.limits.climb_mm != config.limits.descend_mm) {}

  void price(const GridBox& box, bool look_for_uneven) {
    for (int y = box.y0; y <= box.y1; ++y) {
      if (units_per_mm_ > 0) lift_row(y, box.x0, box.x1);
      price_row(y, box.x0, box.x1);
    }
    if (look_for_uneven || some_uneven_) {
      for (int y = box.y0; y <= box.y1; ++y) mark_row(y, box.x0, box.x1);
    }
    find_level_tiles(box);
  }

 private:
  [[nodiscard]] std::size_t height_at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.heights.width) +
           static_cast<std::size_t>(x);
  }

  /// Unknown cells carry on the lift of the one before: it only has to be something near.
  void lift_row(int y, int x0, int x1) {
    const std::int32_t* height = grid_.heights.height_mm.data() + height_at(0, y);
    const std::uint8_t* probability = grid_.heights.probability.data() + height_at(0, y);
    std::int32_t* lift = ground_.lift.data() + ground_.at(0, y);
    for (int x = x0; x <= x1; ++x) {
      const double exact = static_cast<double>(height[x]) * units_per_mm_;
      const auto own = static_cast<std::int32_t>(
          std::floor(std::clamp(exact, -kHighestLift, kHighestLift) + 0.5));
      lift[x] = probability[x] != 0 ? own : lift[x - 1];
    }
  }

  void price_row(int y, int x0, int x1) {
    const std::uint8_t* open = grid_.open.data() + height_at(0, y);
    const std::uint8_t* probability = grid_.heights.probability.data() + height_at(0, y);
    std::uint16_t* price = ground_.price.data() + ground_.at(0, y);
    const std::uint16_t* soft =
        grid_.soft_price.empty() ? nullptr : grid_.soft_price.data() + height_at(0, y);
    for (int x = x0; x <= x1; ++x) {
      const std::uint16_t known = soft != nullptr ? soft[x] : std::uint16_t{kCellUnits};
      price[x] = open[x] == 0 ? std::uint16_t{0} : probability[x] != 0 ? known : unknown_price_;
    }
    for (int x = x0; x <= x1; ++x) {
      std::uint64_t& word = ground_.open_bits[ground_.open_word(x / 64, y)];
      const std::uint64_t bit = std::uint64_t{1} << (x % 64);
      word = open[x] != 0 ? word | bit : word & ~bit;
    }
  }

  void mark_row(int y, int x0, int x1) {
    for (int x = x0; x <= x1; ++x) {
      std::uint16_t& price = ground_.price[ground_.at(x, y)];
      if (price == 0 || !uneven(x, y)) continue;
      price |= PricedGround::kUneven;
      ground_.uneven = true;
    }
  }

  [[nodiscard]] bool uneven(int x, int y) const {
    for (int d = 0; d < 8; ++d) {
      const int other_x = x + kStepX[d];
      const int other_y = y + kStepY[d];
      if (ground_.price[ground_.at(other_x, other_y)] == 0) continue;
      if (special_step(height_at(x, y), height_at(other_x, other_y))) return true;
    }
    return false;
  }

  /// Whether a step from or to unknown ground, or beyond the limits either way.
  [[nodiscard]] bool special_step(std::size_t a, std::size_t b) const {
    const HeightGrid& heights = grid_.heights;
    if (heights.probability[a] == 0 || heights.probability[b] == 0) return true;
    const std::int64_t rise_mm = std::int64_t{heights.height_mm[b]} - heights.height_mm[a];
    return std::abs(rise_mm) > std::min(grid_.limits.climb_mm, grid_.limits.descend_mm);
  }

  void find_level_tiles(const GridBox& box) {
    constexpr int kTile = PricedGround::kTile;
    const int columns = (grid_.heights.width + kTile - 1) / kTile;
    const int rows = (grid_.heights.height + kTile - 1) / kTile;
    const auto tile = [](int cell) { return std::max(cell, 0) / kTile; };
    for (int ty = tile(box.y0 - 1); ty <= std::min(tile(box.y1 + 1), rows - 1); ++ty) {
      for (int tx = tile(box.x0 - 1); tx <= std::min(tile(box.x1 + 1), columns - 1); ++tx) {
        ground_.level_price[static_cast<std::size_t>(ty) * static_cast<std::size_t>(columns) +
                            static_cast<std::size_t>(tx)] = level_price(tx * kTile, ty * kTile);
      }
    }
    const std::vector<std::uint16_t>& all = ground_.level_price;
    ground_.uniform = all.front() != 0 && std::all_of(all.begin(), all.end(), [&](std::uint16_t p) {
                        return p == all.front();
                      });
  }

  /// Of the tile from (x0, y0) on. What is closed all over is as level as can be.
  [[nodiscard]] std::uint16_t level_price(int x0, int y0) const {
    const int x1 = std::min(x0 + PricedGround::kTile, grid_.heights.width);
    const int y1 = std::min(y0 + PricedGround::kTile, grid_.heights.height);
    std::uint16_t lowest = 0xffff;
    std::uint16_t highest = 0;
    for (int y = y0 - 1; y <= y1; ++y) {
      const std::size_t row = ground_.at(0, y);
      if (y < y1 && steps_in_row(row, x0 - 1, x1)) return 0;
      if (y < y0 || y == y1) continue;
      for (int x = x0; x < x1; ++x) {
        const std::uint16_t price = ground_.price[row + static_cast<std::size_t>(x)];
        lowest = std::min(lowest, price != 0 ? price : lowest);
        highest = std::max(highest, price);
      }
    }
    if (highest == 0) return kCellUnits;
    return lowest == highest && highest < PricedGround::kUneven ? highest : std::uint16_t{0};
  }

  /// Whether lifts of open neighbours differ among a row's cells from x0 to x1 and those above.
  [[nodiscard]] bool steps_in_row(std::size_t row, int x0, int x1) const {
    if (units_per_mm_ == 0) return false;
    const std::uint16_t* price = ground_.price.data() + row;
    const std::int32_t* lift = ground_.lift.data() + row;
    const std::ptrdiff_t up = ground_.stride;
    const auto differ = [&](std::ptrdiff_t a, std::ptrdiff_t b) {
      return static_cast<int>(lift[a] != lift[b]) & static_cast<int>(price[a] != 0) &
             static_cast<int>(price[b] != 0);
    };
    int any = differ(x1, x1 + up);
    for (std::ptrdiff_t x = x0; x < x1; ++x) {
      any |= differ(x, x + 1) | differ(x, x + up) | differ(x, x + up + 1) | differ(x + 1, x + up);
    }
    return any != 0;
  }

  DrivableGrid& grid_;
  PricedGround& ground_;
  double units_per_mm_;
  std::uint16_t unknown_price_;
  bool some_uneven_;
};

}  // namespace

void price_ground(DrivableGrid& grid, const PlannerConfig& config, const GridBox& box) {
  PricedGround& ground = grid.ground;
  const bool first_time = ground.stride == 0;
  if (first_time) {
    const HeightGrid& heights = grid.heights;
    ground.stride = heights.width + 1;
    const std::size_t cells = ground.at(0, heights.height + 1);
    ground.lift.resize(cells);
    ground.price.resize(cells);
    const auto tiles = [](int size) {
      return static_cast<std::size_t>((size + PricedGround::kTile - 1) / PricedGround::kTile);
    };
    ground.level_price.resize(tiles(heights.width) * tiles(heights.height));
    ground.open_bits.resize(ground.open_word(-1, heights.height + 1));
    const double sum = config.climb_effort + config.descend_effort;
    ground.one_way = sum > 0 ? (config.climb_effort - config.descend_effort) / sum : 0.0;
  }
  // Classification leaves no step that is forbidden both ways between free cells.
  Pricing(grid, config).price(box, !first_time);
}

std::int32_t GroundReader::effort(std::size_t from, int direction) const {
  const HeightGrid& heights = grid_.heights;
  const std::size_t to = from + static_cast<std::size_t>(step(direction));
  const std::size_t a = height_at(from);
  const std::size_t b = height_at(to);
  if (heights.probability[a] == 0 || heights.probability[b] == 0) {
    // No effort, and so the levelled costs have to lose what they were levelled by.
    return ground_.one_way_effort(from) - ground_.one_way_effort(to);
  }
  const std::int64_t rise_mm = std::int64_t{heights.height_mm[b]} - heights.height_mm[a];
  const bool possible = rise_mm <= grid_.limits.climb_mm && -rise_mm <= grid_.limits.descend_mm;
  return possible ? std::abs(ground_.lift[to] - ground_.lift[from]) : Field::kClosed;
}

Offers GroundReader::uneven(const std::int32_t* levelled, std::size_t cell) const {
  std::int32_t neighbour[8];
  Offers offers;
  for (int d = 0; d < 8; ++d) {
    const std::size_t other = cell + static_cast<std::size_t>(step(d));
    neighbour[d] = levelled[other];
    const bool reached = neighbour[d] < Field::kUnreached;
    const std::int32_t more = reached ? effort(cell, d) : Field::kClosed;
    offers.cost[d] = more < Field::kClosed ? neighbour[d] + more : Field::kClosed;
  }
  close_corners(offers, neighbour);
  return offers;
}

std::uint32_t step_cost(const DrivableGrid& grid, CellIndex from, int direction) {
  const CellIndex to{from.x + kStepX[direction], from.y + kStepY[direction]};
  if (!grid.heights.contains(from) || !grid.heights.contains(to)) return kNoWay;
  const GroundReader ground(grid);
  const auto closed = [&](int x, int y) { return ground.closed(grid.ground_at({x, y})); };
  const std::size_t cell = grid.ground_at(from);
  if (ground.closed(cell) || closed(to.x, to.y)) return kNoWay;
  const bool diagonal = (direction & 1) != 0;
  if (diagonal && (closed(from.x, to.y) || closed(to.x, from.y))) return kNoWay;
  const std::int32_t effort = ground.effort(cell, direction);
  if (effort >= Field::kClosed) return kNoWay;
  const std::int32_t price = ground.price(cell);
  const std::int32_t one_way =
      grid.ground.one_way_effort(grid.ground_at(to)) - grid.ground.one_way_effort(cell);
  return static_cast<std::uint32_t>((diagonal ? diagonal_units(price) : price) + effort + one_way);
}

Field unreached_field(const DrivableGrid& grid, CellIndex goal) {
  const std::vector<std::uint16_t>& price = grid.ground.price;
  Field field{grid.heights.origin, grid.heights.width, grid.heights.height, goal, {}};
  field.levelled.resize(price.size());
  std::transform(price.begin(), price.end(), field.levelled.begin(),
                 [](std::uint16_t p) { return p != 0 ? Field::kUnreached : Field::kClosed; });
  return field;
}

std::uint32_t cost_to_goal(const DrivableGrid& grid, const Field& field, CellIndex cell) {
  if (!grid.heights.contains(cell)) return kNoWay;
  const std::size_t at = grid.ground_at(cell);
  if (field.levelled[at] >= Field::kUnreached) return kNoWay;
  const std::int32_t back =
      grid.ground.one_way_effort(grid.ground_at(field.goal)) - grid.ground.one_way_effort(at);
  return static_cast<std::uint32_t>(field.levelled[at] + back);
}

}  // namespace cairn
