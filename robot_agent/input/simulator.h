#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/common/result.h"
#include "robot_agent/input/input.h"
#include "robot_agent/input/instruments.h"
#include "robot_agent/input/vehicle.h"
#include "robot_agent/input/world.h"

namespace cairn::agent {

/// What the simulated laser scanners get wrong.
struct LaserNoise {
  double range_sigma_m = 0.015;        ///< [m] Standard deviation of one range. [Limit: 0 … 1]
  double dropout_probability = 0.002;  ///< [-] A beam that finds no return. [Limit: 0 … 1]
};

/// A robot with two lasers in a world made by `make_world`.
struct SimulatorConfig {
  std::string world = "room";    ///< One of `world_names()`, or dem:FILE[@CELL_SIZE].
  std::uint64_t seed = 1;        ///< Furniture, terrain and every noise follow from it.
  double scan_rate_hz = 5.0;     ///< Sweeps of each laser. [Limit: > 0 … 100]
  double motion_rate_hz = 20.0;  ///< Odometer, gyro, inclinometer. [Limit: > 0 … 100]
  VehicleConfig vehicle;
  InstrumentConfig instruments;
  LaserNoise lasers;
};

/// Every fault of the configuration in one sentence each, joined by "; ". Empty when it is sound.
[[nodiscard]] std::string faults(const SimulatorConfig& config);

/// A simulated ATRV-Jr. Its time passes in ticks of 10 ms, so what it reads depends on the seed and
/// on the tick at which each command came, never on how `advance` is cut up. Readings start at time
/// 0 with a MotionReading; of readings with equal stamps the motion comes first. `truth()` is as of
/// the last tick. Errors: a faulty configuration, an unknown world, an unreadable terrain file.
[[nodiscard]] Result<std::unique_ptr<Input>> make_simulator(const SimulatorConfig& config);

/// The same in a world that is already there.
[[nodiscard]] Result<std::unique_ptr<Input>> make_simulator(const SimulatorConfig& config,
                                                            World world);

}  // namespace cairn::agent
