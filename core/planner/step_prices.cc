#include "core/planner/step_prices.h"

#include <cmath>
#include <numbers>
#include <string>

namespace cairn {
namespace {

void check(std::string& faults, bool sound, const char* fault) {
  if (sound) return;
  if (!faults.empty()) faults += "; ";
  faults += fault;
}

bool within(double value, double lowest, double highest) {
  return value >= lowest && value <= highest;  // false for NaN
}

}  // namespace

std::string faults(const PlannerConfig& config) {
  std::string all;
  check(all, config.limits.climb_mm >= 0, "climb_mm must not be negative");
  check(all, config.limits.descend_mm >= 0, "descend_mm must not be negative");
  check(all, within(config.limits.radius_m, 0, 10), "radius_m must be from 0 to 10");
  check(all, within(config.unknown_price, 1, 100), "unknown_price must be from 1 to 100");
  check(all, within(config.climb_effort, 0, 100), "climb_effort must be from 0 to 100");
  check(all, within(config.descend_effort, 0, 100), "descend_effort must be from 0 to 100");
  return all;
}

StepPrices::StepPrices(const PlannerConfig& config, int cell_size_mm)
    : axial_(std::int64_t{cell_size_mm} * 10),
      diagonal_(std::llround(cell_size_mm * 10.0 * std::numbers::sqrt2)),
      unknown_price_(std::llround(config.unknown_price * 1000)),
      climb_effort_(std::llround(config.climb_effort * 1000)),
      descend_effort_(std::llround(config.descend_effort * 1000)),
      climb_mm_(config.limits.climb_mm),
      descend_mm_(config.limits.descend_mm) {}

std::uint32_t step_cost(const DrivableGrid& grid, const PlannerConfig& config, std::size_t from,
                        int direction) {
  const HeightGrid& heights = grid.heights;
  const auto width = static_cast<std::size_t>(heights.width);
  const int dx = kStepX[direction];
  const int dy = kStepY[direction];
  const int x = static_cast<int>(from % width) + dx;
  const int y = static_cast<int>(from / width) + dy;
  if (x < 0 || y < 0 || x >= heights.width || y >= heights.height) return kNoWay;
  const auto at = [width](int cell_x, int cell_y) {
    return static_cast<std::size_t>(cell_y) * width + static_cast<std::size_t>(cell_x);
  };
  const bool diagonal = dx != 0 && dy != 0;
  const bool cuts_corner = diagonal && !(grid.open[at(x - dx, y)] && grid.open[at(x, y - dy)]);
  if (!grid.open[at(x, y)] || cuts_corner) return kNoWay;
  return StepPrices(config, heights.cell_size_mm).between(heights, from, at(x, y), diagonal);
}

}  // namespace cairn
