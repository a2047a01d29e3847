#include "core/planner/field_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <tuple>
#include <unordered_map>

namespace cairn {
namespace {

/// Points tried between two neighbouring middles.
constexpr int kFractions = 8;
/// [cost units] A step of a walk comes at least this much nearer to the goal.
constexpr double kProgress = 100;

/// One walk down a field, in cells of the grid.
class Walk {
 public:
  Walk(const DrivableGrid& grid, const Field& field, const LineCost& lines)
      : grid_(grid),
        field_(field),
        lines_(lines),
        cell_m_(grid.heights.cell_size_mm / 1000.0),
        origin_(grid.heights.origin.x, grid.heights.origin.y) {}

  [[nodiscard]] std::vector<Eigen::Vector2d> from(const Eigen::Vector2d& start_m,
                                                  const Eigen::Vector2d& goal_m) {
    std::vector<Eigen::Vector2d> points_m{start_m};
    double left = HUGE_VAL;
    while (!beside_goal(points_m.back()) || !lines_.between(points_m.back(), goal_m)) {
      const Step step = best_step(points_m.back() / cell_m_ - origin_);
      if (!(step.left < left - kProgress)) return {};
      left = step.left;
      points_m.push_back((step.to + origin_) * cell_m_);
    }
    points_m.push_back(goal_m);
    return points_m;
  }

 private:
  struct Step {
    double cost = HUGE_VAL;  ///< With what is left.
    double left = HUGE_VAL;  ///< Levelled cost at its end.
    Eigen::Vector2d to;      ///< [cells]
  };

  [[nodiscard]] bool beside_goal(const Eigen::Vector2d& point_m) const {
    const Eigen::Vector2d p = point_m / cell_m_;
    return std::abs(std::floor(p.x()) - field_.goal.x) <= 1 &&
           std::abs(std::floor(p.y()) - field_.goal.y) <= 1;
  }

  /// What may be stepped to from a cell. [Limit: as many as the ring has places]
  class Steps {
   public:
    void add(const Step& step) { steps_[static_cast<std::size_t>(size_++)] = step; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    [[nodiscard]] Step take_best() {
      const auto best =
          std::min_element(steps_.begin(), steps_.begin() + size_,
                           [](const Step& a, const Step& b) { return a.cost < b.cost; });
      std::swap(*best, steps_[static_cast<std::size_t>(--size_)]);
      return steps_[static_cast<std::size_t>(size_)];
    }

   private:
    std::array<Step, 8 * kFractions> steps_;
    std::ptrdiff_t size_ = 0;
  };

  /// The best step from `place` to the ring of middles around its cell that can be driven.
  [[nodiscard]] Step best_step(const Eigen::Vector2d& place) const {
    Steps steps = steps_to_ring(place);
    while (!steps.empty()) {
      Step best = steps.take_best();
      if (lines_.between((place + origin_) * cell_m_, (best.to + origin_) * cell_m_)) return best;
    }
    return {};
  }

  [[nodiscard]] Steps steps_to_ring(const Eigen::Vector2d& place) const {
    const auto x = static_cast<int>(std::floor(place.x()));
    const auto y = static_cast<int>(std::floor(place.y()));
    const double price = grid_.ground.price[grid_.ground.at(x, y)] & PricedGround::kPriceMask;
    const double lift = lines_.lift_at(place);
    const std::array<Spot, 8> ring = ring_around(x, y);
    Steps steps;
    for (std::size_t d = 0; d < 8; ++d) {
      const Spot& spot = ring[d];
      const Spot& other = ring[(d + 1) & 7];
      const bool both = std::max(spot.levelled, other.levelled) < Field::kUnreached;
      if (!(spot.levelled < Field::kUnreached)) continue;
      for (int i = 0; i < (both ? kFractions : 1); ++i) {
        const double fraction = static_cast<double>(i) / kFractions;
        const Eigen::Vector2d to = spot.place + fraction * (other.place - spot.place);
        const double left = spot.levelled + fraction * (other.levelled - spot.levelled);
        const double risen = spot.lift + fraction * (other.lift - spot.lift) - lift;
        steps.add({price * (to - place).norm() + std::abs(risen) + left, left, to});
      }
    }
    return steps;
  }

  /// A cell's middle.
  struct Spot {
    Eigen::Vector2d place;
    double levelled;
    double lift;
  };

  [[nodiscard]] std::array<Spot, 8> ring_around(int x, int y) const {
    std::array<Spot, 8> ring;
    for (std::size_t d = 0; d < 8; ++d) {
      const std::size_t at = grid_.ground.at(x + kStepX[d], y + kStepY[d]);
      ring[d] = {{x + kStepX[d] + 0.5, y + kStepY[d] + 0.5},
                 static_cast<double>(field_.levelled[at]),
                 static_cast<double>(grid_.ground.lift[at])};
    }
    return ring;
  }

  const DrivableGrid& grid_;
  const Field& field_;
  const LineCost& lines_;
  const double cell_m_;
  const Eigen::Vector2d origin_;
};

/// The neighbour to go to from a reached cell other than the goal.
int direction_down(const GroundReader& ground, const Field& field, std::size_t cell) {
  const Offers offers = ground.offers(field.levelled.data(), cell);
  const std::int32_t price = ground.price(cell);
  std::int32_t best = Field::kUnreached;
  int direction = 0;
  for (int axial = 0; axial < 8; axial += 2) {
    for (const int diagonal : {(axial + 1) & 7, (axial + 7) & 7}) {
      const std::int32_t a = offers.cost[axial];
      const std::int32_t b = offers.cost[diagonal];
      const std::int32_t cost = through_triangle(a, b, price);
      if (cost >= best) continue;
      best = cost;
      // The way meets the line between the two half-way where a - b is price / √5.
      direction = a - b > price * 4 / 9 ? diagonal : axial;
    }
  }
  return direction;
}

}  // namespace

std::vector<CellIndex> cells_down(const DrivableGrid& grid, const Field& field, CellIndex start) {
  const GroundReader ground(grid);
  std::vector<CellIndex> cells{start};
  while (!(cells.back() == field.goal)) {
    const int d = direction_down(ground, field, grid.ground_at(cells.back()));
    cells.push_back({cells.back().x + kStepX[d], cells.back().y + kStepY[d]});
  }
  return cells;
}

int first_step_down(const DrivableGrid& grid, const Field& field, CellIndex cell) {
  return direction_down(GroundReader(grid), field, grid.ground_at(cell));
}

std::vector<Eigen::Vector2d> walk_down(const DrivableGrid& grid, const Field& field,
                                       const LineCost& lines, const Eigen::Vector2d& start_m,
                                       const Eigen::Vector2d& goal_m) {
  return Walk(grid, field, lines).from(start_m, goal_m);
}

std::vector<CellIndex> cheapest_cells(const DrivableGrid& grid, const Field& field, CellIndex start,
                                      double below) {
  struct Known {
    std::uint32_t cost;
    int direction;  ///< It was reached by.
  };
  using Item = std::tuple<std::uint32_t, std::int32_t, std::int32_t>;
  const auto key = [&](CellIndex cell) { return grid.ground_at(cell); };
  std::unordered_map<std::size_t, Known> known{{key(start), {0, -1}}};
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  queue.emplace(cost_to_goal(grid, field, start), start.x, start.y);
  while (!queue.empty()) {
    const auto [estimate, x, y] = queue.top();
    queue.pop();
    CellIndex cell{x, y};
    const std::uint32_t so_far = known.at(key(cell)).cost;
    if (so_far + cost_to_goal(grid, field, cell) != estimate) continue;
    if (cell == field.goal) {
      std::vector<CellIndex> cells{cell};
      for (int d = known.at(key(cell)).direction; d >= 0;
           d = known.at(key(cells.back())).direction) {
        cells.push_back({cells.back().x - kStepX[d], cells.back().y - kStepY[d]});
      }
      return {cells.rbegin(), cells.rend()};
    }
    for (int d = 0; d < 8; ++d) {
      const std::uint32_t step = step_cost(grid, cell, d);
      const CellIndex next{cell.x + kStepX[d], cell.y + kStepY[d]};
      const std::uint32_t left = cost_to_goal(grid, field, next);
      if (step == kNoWay || left == kNoWay || so_far + step + left >= below) continue;
      const auto [found, is_new] = known.try_emplace(key(next), Known{so_far + step, d});
      if (!is_new && found->second.cost <= so_far + step) continue;
      found->second = {so_far + step, d};
      queue.emplace(so_far + step + left, next.x, next.y);
    }
  }
  return {};
}

}  // namespace cairn
