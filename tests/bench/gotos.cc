// Random goals in a block of a city (or --world NAME) of which the robot has the map, with ten
// things in the way that are not on it: six boxes and four people who walk to and fro. Each ten
// goals another robot among other things. Also says how well the robot knew where it was.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "core/common/angle.h"
#include "core/map/update.h"
#include "core/sensor/laser.h"
#include "robot_agent/input/paint.h"
#include "robot_agent/input/ray_caster.h"
#include "robot_agent/input/simulator.h"
#include "robot_agent/input/vehicle.h"
#include "tests/bench/report.h"
#include "tests/bench/solo_robot.h"
#include "tests/bench/true_ground.h"

namespace cairn::bench {
namespace {

constexpr int kCellMm = 125;
/// [m] Goals are where a vehicle fits that needs a little more room than ours.
constexpr double kRoomM = 0.7;
constexpr int kGoalsPerRobot = 10;
constexpr int kBoxes = 6;
constexpr int kPeople = 4;
constexpr double kNearestGoalM = 8.0;
constexpr double kFarthestGoalM = 35.0;
constexpr Duration kLimit = std::chrono::minutes(6);

using Random = std::mt19937_64;

double between(double low, double high, Random& random) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Whether an operator could choose it: on the robot's map, with room for the vehicle.
bool on_map(const DrivableGrid& known, const Eigen::Vector2d& place_m) {
  const double cell_m = kCellMm / 1000.0;
  const CellIndex cell{static_cast<std::int32_t>(std::floor(place_m.x() / cell_m)),
                       static_cast<std::int32_t>(std::floor(place_m.y() / cell_m))};
  return known.heights.contains(cell) && known.open[known.heights.at(cell)] != 0;
}

/// Somewhere near `from_m` to which there is a way.
Eigen::Vector2d reachable_place(const DrivableGrid& ground, const Field& from_here,
                                const Eigen::Vector2d& from_m, Random& random) {
  const double cell_m = kCellMm / 1000.0;
  while (true) {
    const double angle = between(-3.14159, 3.14159, random);
    const double far_m = between(kNearestGoalM, kFarthestGoalM, random);
    const Eigen::Vector2d place_m =
        from_m + far_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const CellIndex cell{static_cast<std::int32_t>(std::floor(place_m.x() / cell_m)),
                         static_cast<std::int32_t>(std::floor(place_m.y() / cell_m))};
    if (cost_to_goal(ground, from_here, cell) != kNoWay) return place_m;
  }
}

/// Beside an obstacle the ground's height in a cell is not that in its middle.
bool near_obstacle(const DrivableGrid& ground, int x, int y) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const CellIndex cell{ground.heights.origin.x + x + dx, ground.heights.origin.y + y + dy};
      if (!ground.heights.contains(cell) ||
          ground.classes[ground.heights.at(cell)] == CellClass::obstacle) {
        return true;
      }
    }
  }
  return false;
}

/// The map that robots have made by driving everywhere, without any error of their poses: all the
/// ground that they can drive on, and of what stands there the faces that they see, looking around
/// in four directions every two metres.
HeightMap map_of(const agent::World& world, const DrivableGrid& ground, const Field& reachable,
                 Random& random) {
  constexpr double kEveryM = 2.0;
  const agent::RayCaster caster(world.surface);
  const std::vector<LaserSpec> lasers = atrv_jr_lasers();
  ScanIntegrator integrator(SensorModel{});
  HeightMap map(kCellMm);
  std::normal_distribution<double> error_mm(0.0, 5.0);
  for (int y = 0; y < ground.heights.height; ++y) {
    for (int x = 0; x < ground.heights.width; ++x) {
      const CellIndex cell{ground.heights.origin.x + x, ground.heights.origin.y + y};
      const std::size_t at = ground.heights.at(cell);
      if (ground.classes[at] != CellClass::free || near_obstacle(ground, x, y)) continue;
      const auto off_mm = static_cast<std::int32_t>(std::lround(error_mm(random)));
      if (ground.heights.height_mm[at] < 1000) {
        map.set(cell, {ground.heights.height_mm[at] + off_mm, 240});
      }
    }
  }
  for (double y_m = world.surface.south_m() + 1.0; y_m < world.surface.north_m(); y_m += kEveryM) {
    for (double x_m = world.surface.west_m() + 1.0; x_m < world.surface.east_m(); x_m += kEveryM) {
      if (cost_to_goal(ground, reachable, map.cell_at(x_m, y_m)) == kNoWay) continue;
      for (int look = 0; look < 4; ++look) {
        const Pose robot =
            agent::Vehicle({}, world.surface, {x_m, y_m, 0, 0, 0, radians(90 * look)}).pose();
        for (std::size_t i = 0; i < lasers.size(); ++i) {
          integrator.integrate(map,
                               beams_in_site(sweep(caster, lasers[i], i, robot, 0.015, random),
                                             lasers[i], robot, 15.0),
                               std::nullopt, nullptr);
        }
      }
    }
  }
  return map;
}

Field field_from(const DrivableGrid& ground, const Eigen::Vector2d& from_m) {
  const double cell_m = kCellMm / 1000.0;
  return compute_field(ground, {static_cast<std::int32_t>(std::floor(from_m.x() / cell_m)),
                                static_cast<std::int32_t>(std::floor(from_m.y() / cell_m))})
      .value();
}

/// Puts boxes and people on ways that somebody might take.
void populate(agent::World& world, Random& random) {
  const Eigen::Vector2d start_m(world.start.x_m, world.start.y_m);
  const DrivableGrid ground = true_ground(world, kCellMm, kRoomM);
  const Field field = field_from(ground, start_m);
  for (int i = 0; i < kBoxes + kPeople; ++i) {
    Eigen::Vector2d place_m = reachable_place(ground, field, start_m, random);
    while ((place_m - start_m).norm() < 3.0) {
      place_m = reachable_place(ground, field, start_m, random);
    }
    if (i < kBoxes) {
      agent::put_box(world.surface,
                     {place_m.x(), place_m.y(), between(0.3, 1.5, random),
                      between(0.3, 1.0, random), between(0.0, 3.0, random)},
                     between(0.45, 1.5, random));
      continue;
    }
    const double z_m = world.surface.height_m(place_m.x(), place_m.y());
    const double heading = between(-3.14159, 3.14159, random);
    world.passers_by.push_back(
        {place_m, place_m + 6.0 * Eigen::Vector2d(std::cos(heading), std::sin(heading)),
         between(0.3, 1.2, random), 0.25, z_m + 1.8});
  }
}

struct Totals {
  int goals = 0;
  int arrived = 0;
  int collisions = 0;
  int paths = 0;
  double driven_m = 0.0;
  double planned_m = 0.0;
  double worst_m = 0.0;  ///< Of those that arrived, from the goal, in truth.
  // Of the pose that the robot believes in, at the end of each way.
  double position_m = 0.0;
  double worst_position_m = 0.0;
  double worst_z_m = 0.0;
  double worst_yaw_rad = 0.0;

  void note(const Pose& believed, const Pose& truth) {
    const double off_m = std::hypot(believed.x_m - truth.x_m, believed.y_m - truth.y_m);
    position_m += off_m;
    worst_position_m = std::max(worst_position_m, off_m);
    worst_z_m = std::max(worst_z_m, std::abs(believed.z_m - truth.z_m));
    worst_yaw_rad = std::max(worst_yaw_rad, std::abs(wrap_angle(believed.yaw_rad - truth.yaw_rad)));
  }
};

void drive_goals(const std::string& name, std::uint64_t seed, int goals, Totals& totals) {
  Random random(seed);
  agent::World world = agent::make_world(name, seed).value();
  const DrivableGrid empty = true_ground(world, kCellMm, kRoomM);
  const HeightMap map =
      map_of(world, empty, field_from(empty, {world.start.x_m, world.start.y_m}), random);
  populate(world, random);
  const DrivableGrid ground = true_ground(world, kCellMm, kRoomM);
  agent::SimulatorConfig config;
  config.world = name;
  config.seed = seed;
  SoloRobot robot(agent::make_simulator(config, std::move(world)).value(), &map);
  const DrivableGrid known = robot.ground();
  for (int i = 0; i < goals; ++i) {
    const Pose here = robot.truth().T_site_robot;
    const Eigen::Vector2d here_m(here.x_m, here.y_m);
    const auto field = compute_field(ground, {static_cast<std::int32_t>(std::floor(here.x_m * 8)),
                                              static_cast<std::int32_t>(std::floor(here.y_m * 8))});
    if (!field) break;  // It stands too near to something to say where it could go.
    Eigen::Vector2d goal_m = reachable_place(ground, *field, here_m, random);
    while (!on_map(known, goal_m)) goal_m = reachable_place(ground, *field, here_m, random);
    const int collisions = robot.truth().collisions;
    const SoloRobot::Trip trip = robot.go_to(goal_m, kLimit);
    const Pose end = robot.truth().T_site_robot;
    const double off_m = std::hypot(end.x_m - goal_m.x(), end.y_m - goal_m.y());
    ++totals.goals;
    totals.note(robot.mapper().pose(), end);
    totals.paths += trip.paths;
    totals.collisions += robot.truth().collisions - collisions;
    std::cout << "seed " << seed << " goal " << i << ": "
              << (trip.arrived ? "arrived" : "NOT there") << ", " << off_m << " m off, driven "
              << trip.driven_m << " of " << trip.planned_m << " m planned, " << trip.paths
              << " paths, " << robot.truth().collisions - collisions << " collisions"
              << (trip.why.empty() ? "" : " (" + trip.why + ")") << std::endl;
    if (!trip.arrived) continue;
    ++totals.arrived;
    totals.driven_m += trip.driven_m;
    totals.planned_m += trip.planned_m;
    totals.worst_m = std::max(totals.worst_m, off_m);
  }
}

int run(const std::string& world, int goals, std::uint64_t first_seed) {
  Totals totals;
  for (std::uint64_t seed = first_seed; totals.goals < goals; ++seed) {
    drive_goals(world, seed, std::min(kGoalsPerRobot, goals - totals.goals), totals);
  }
  Report report("gotos");
  report.add({"arrived", 100.0 * totals.arrived / totals.goals, "%", Better::higher, 99.0});
  report.add({"collisions", static_cast<double>(totals.collisions), "", Better::lower, 0.0});
  report.add({"worst distance from the goal", totals.worst_m, "m", Better::lower, 0.125});
  report.add({"way driven beyond the first plan",
              100.0 * (totals.driven_m / std::max(1.0, totals.planned_m) - 1.0), "%"});
  report.add({"paths planned per goal", static_cast<double>(totals.paths) / totals.goals, ""});
  report.add({"position error, mean", totals.position_m / totals.goals, "m"});
  report.add({"position error, worst", totals.worst_position_m, "m"});
  report.add({"z error, worst", totals.worst_z_m, "m"});
  report.add({"yaw error, worst", degrees(totals.worst_yaw_rad), "°"});
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  std::string world = "block";
  int goals = 200;
  std::uint64_t first_seed = 400;
  bool usable = argc % 2 == 1;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i];
    if (option == "--world") {
      world = argv[i + 1];
    } else if (option == "--goals") {
      goals = std::atoi(argv[i + 1]);
    } else if (option == "--seed") {
      first_seed = std::strtoull(argv[i + 1], nullptr, 10);
    } else {
      usable = false;
    }
  }
  if (!usable || goals < 1 || goals > 100'000) {
    std::cerr << "usage: " << argv[0]
              << " [--world NAME] [--goals N] [--seed FIRST], N from 1 to 100,000\n";
    return 2;
  }
  if (const auto made = cairn::agent::make_world(world, 1); !made) {
    std::cerr << made.error().message << '\n';
    return 1;
  }
  return cairn::bench::run(world, goals, first_seed);
}
