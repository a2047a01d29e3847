#include <algorithm>
#include <cmath>

#include "core/map/hidden_steps.h"
#include "core/map/soft_ground.h"
#include "core/planner/trulla.h"

namespace cairn {
namespace {

/// [cells] Distances to the nearest obstacle, cut off.
class Clearance {
 public:
  Clearance(const DrivableGrid& grid, int farthest)
      : grid_(grid), farthest_(farthest), column_(grid.classes.size()) {
    const int height = grid.heights.height;
    std::vector<int> rows(static_cast<std::size_t>(grid.heights.width), farthest);
    for (int y = 0; y < height; ++y) pass(y, rows);
    std::fill(rows.begin(), rows.end(), farthest);
    for (int y = height - 1; y >= 0; --y) pass(y, rows);
  }

  /// Exact up to the farthest: the nearest of every column within reach.
  [[nodiscard]] double at(int x, int y) const {
    int nearest = farthest_ * farthest_;
    const int last = std::min(x + farthest_, grid_.heights.width - 1);
    for (int other = std::max(x - farthest_, 0); other <= last; ++other) {
      const int rows = column_[index(other, y)];
      nearest = std::min(nearest, rows * rows + (other - x) * (other - x));
    }
    return std::sqrt(nearest);
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.heights.width) +
           static_cast<std::size_t>(x);
  }

  /// Rows to the nearest obstacle in the same column among those passed, and before.
  void pass(int y, std::vector<int>& rows) {
    for (int x = 0; x < grid_.heights.width; ++x) {
      int& distance = rows[static_cast<std::size_t>(x)];
      const std::size_t cell = index(x, y);
      distance = grid_.classes[cell] == CellClass::obstacle ? 0 : std::min(distance + 1, farthest_);
      const bool first_pass = column_[cell] == 0;  // An obstacle stays 0 either way.
      const int before = first_pass ? farthest_ : column_[cell];
      column_[cell] = static_cast<std::uint16_t>(std::min(before, distance));
    }
  }

  const DrivableGrid& grid_;
  int farthest_;
  std::vector<std::uint16_t> column_;
};

double cell_m(const DrivableGrid& grid) { return grid.heights.cell_size_mm / 1000.0; }

/// [cells]
int farthest_closeness(const DrivableGrid& grid, const PlannerConfig& config) {
  if (config.closeness_price == 0.0) return 0;
  return static_cast<int>((config.limits.radius_m + config.closeness_m) / cell_m(grid)) + 1;
}

bool looks_at_shape(const PlannerConfig& config) {
  return config.obstacle_price > 0 || config.roughness_price > 0 || config.slope_price > 0;
}

/// Adds to every cell's price, in parts of level ground.
class SoftPricing {
 public:
  SoftPricing(const DrivableGrid& grid, const PlannerConfig& config)
      : grid_(grid), config_(config), extra_(grid.classes.size()) {}

  void add_weights() {
    for (std::size_t i = 0; i < extra_.size(); ++i) extra_[i] += grid_.weights[i] / 16.0F;
  }

  void add_shape() {
    SoftGround ground;
    assess(grid_.heights, config_.limits, config_.soft, ground);
    const auto obstacle = static_cast<float>(config_.obstacle_price / 255);
    const auto roughness = static_cast<float>(config_.roughness_price / 100);
    const auto slope = static_cast<float>(config_.slope_price / 100);
    for (std::size_t i = 0; i < extra_.size(); ++i) {
      extra_[i] += static_cast<float>(ground.obstacle[i]) * obstacle;
      extra_[i] += static_cast<float>(ground.roughness_mm[i]) * roughness;
      extra_[i] += static_cast<float>(ground.slope_percent[i]) * slope;
    }
  }

  void add_closeness() {
    const Clearance clearance(grid_, farthest_closeness(grid_, config_));
    for (int y = 0; y < grid_.heights.height; ++y) {
      for (int x = 0; x < grid_.heights.width; ++x) {
        const std::size_t i =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.heights.width) +
            static_cast<std::size_t>(x);
        if (!grid_.open[i]) continue;
        const double beyond_m = clearance.at(x, y) * cell_m(grid_) - config_.limits.radius_m;
        const double part = 1.0 - std::max(beyond_m, 0.0) / config_.closeness_m;
        extra_[i] += static_cast<float>(std::max(part, 0.0) * config_.closeness_price);
      }
    }
  }

  [[nodiscard]] std::vector<std::uint16_t> prices() const {
    std::vector<std::uint16_t> prices(extra_.size());
    std::transform(extra_.begin(), extra_.end(), prices.begin(), [](float extra) {
      const float price = kCellUnits * (1.0F + extra) + 0.5F;
      return static_cast<std::uint16_t>(std::min(price, float{PricedGround::kPriceMask}));
    });
    return prices;
  }

 private:
  const DrivableGrid& grid_;
  const PlannerConfig& config_;
  std::vector<float> extra_;
};

}  // namespace

int reach_of_change(const DrivableGrid& grid, const PlannerConfig& config) {
  const double cells =
      std::max({config.limits.radius_m / cell_m(grid), 1.0 * farthest_closeness(grid, config),
                looks_at_shape(config) ? config.soft.wheel_base_m / cell_m(grid) : 0.0});
  return 1 + std::max(kSplitStepReach, kHiddenStepReach) + static_cast<int>(cells);
}

void price_softly(DrivableGrid& grid, const PlannerConfig& config) {
  const bool weighted = !grid.weights.empty();
  if (!weighted && !looks_at_shape(config) && config.closeness_price == 0.0) return;
  SoftPricing pricing(grid, config);
  if (weighted) pricing.add_weights();
  if (looks_at_shape(config)) pricing.add_shape();
  if (config.closeness_price > 0.0) pricing.add_closeness();
  grid.soft_price = pricing.prices();
}

}  // namespace cairn
