#pragma once

#include <random>

#include "core/planner/trulla.h"
#include "core/sensor/laser.h"
#include "robot_agent/input/ray_caster.h"
#include "robot_agent/input/world.h"

namespace cairn::bench {

/// The ground as it is, for a vehicle that needs `radius_m` of room.
[[nodiscard]] DrivableGrid true_ground(const agent::World& world, int cell_size_mm,
                                       double radius_m);

/// One sweep of a laser, its readings off by `sigma_m`.
[[nodiscard]] Scan sweep(const agent::RayCaster& caster, const LaserSpec& laser, std::size_t index,
                         const Pose& robot, double sigma_m, std::mt19937_64& random);

}  // namespace cairn::bench
