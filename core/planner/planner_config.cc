#include <string>

#include "core/planner/trulla.h"

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
  check(all, within(config.unknown_price, 1, 30), "unknown_price must be from 1 to 30");
  check(all, within(config.climb_effort, 0, 100), "climb_effort must be from 0 to 100");
  check(all, within(config.descend_effort, 0, 100), "descend_effort must be from 0 to 100");
  check(all, within(config.soft.sigma_mm, 1, 1000), "sigma_mm must be from 1 to 1000");
  check(all, within(config.soft.wheel_base_m, 0.01, 2), "wheel_base_m must be from 0.01 to 2");
  check(all, within(config.obstacle_price, 0, 30), "obstacle_price must be from 0 to 30");
  check(all, within(config.roughness_price, 0, 30), "roughness_price must be from 0 to 30");
  check(all, within(config.slope_price, 0, 30), "slope_price must be from 0 to 30");
  check(all, within(config.closeness_price, 0, 30), "closeness_price must be from 0 to 30");
  check(all, within(config.closeness_m, 0.01, 5), "closeness_m must be from 0.01 to 5");
  return all;
}

}  // namespace cairn
