#include "tests/bench/true_ground.h"

#include <cmath>
#include <utility>

#include "tests/bench/world_height.h"

namespace cairn::bench {

DrivableGrid true_ground(const agent::World& world, int cell_size_mm, double radius_m) {
  const WorldHeight height(world.surface);
  const double cell_m = cell_size_mm / 1000.0;
  const auto index = [&](double m) { return static_cast<std::int32_t>(std::floor(m / cell_m)); };
  auto grid = empty_grid({index(world.surface.west_m()) + 1, index(world.surface.south_m()) + 1},
                         {index(world.surface.east_m()) - 1, index(world.surface.north_m()) - 1},
                         cell_size_mm)
                  .value();
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const std::size_t at = grid.at({grid.origin.x + x, grid.origin.y + y});
      const double z_m =
          height((grid.origin.x + x + 0.5) * cell_m, (grid.origin.y + y + 0.5) * cell_m);
      grid.height_mm[at] = static_cast<std::int32_t>(std::lround(z_m * 1000.0));
      grid.probability[at] = 250;
    }
  }
  PlannerConfig config;
  config.limits.radius_m = radius_m;
  return make_drivable(std::move(grid), config);
}

Scan sweep(const agent::RayCaster& caster, const LaserSpec& laser, std::size_t index,
           const Pose& robot, double sigma_m, std::mt19937_64& random) {
  const Eigen::Isometry3d T = to_transform(robot) * to_transform(laser.T_robot_sensor);
  std::normal_distribution<double> error_m(0.0, 1.0);
  Scan scan{{}, index, {}};
  for (int i = 0; i < laser.beam_count; ++i) {
    const double angle = laser.first_angle_rad + i * laser.step_rad;
    const double range_m = caster.range_m(
        T.translation(), T.linear() * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0),
        laser.max_range_m);
    const bool hit = range_m < laser.max_range_m;
    scan.range_m.push_back(static_cast<float>(hit ? range_m + sigma_m * error_m(random) : range_m));
  }
  return scan;
}

}  // namespace cairn::bench
