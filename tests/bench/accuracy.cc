// How exactly registration finds 200 random displacements, each in a world never seen before.

#include <cmath>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "core/common/angle.h"
#include "core/localization/registration.h"
#include "robot_agent/input/world.h"
#include "tests/bench/report.h"
#include "tests/bench/world_height.h"
#include "tests/support/sampled_ground.h"

namespace cairn::bench {
namespace {

constexpr int kTrials = 200;
constexpr int kCellMm = 125;
constexpr std::uint64_t kFirstSeed = 1000;

struct Errors {
  double squares_m2 = 0.0;
  double squares_rad2 = 0.0;
  int count = 0;

  void add(const Pose& found, const Pose& truth) {
    squares_m2 += std::pow(found.x_m - truth.x_m, 2) + std::pow(found.y_m - truth.y_m, 2);
    squares_rad2 += std::pow(wrap_angle(found.yaw_rad - truth.yaw_rad), 2);
    ++count;
  }
  [[nodiscard]] double rms_cm() const { return 100.0 * std::sqrt(squares_m2 / count); }
  [[nodiscard]] double rms_deg() const { return degrees(std::sqrt(squares_rad2 / count)); }
};

struct Methods {
  Errors prior, best_cell, thesis, cairn;
  int refused = 0;
};

/// Registers a map made at a random place near where the robot believes to be.
void try_once(const agent::World& world, std::uint64_t seed, Methods& methods) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> one(-1.0, 1.0);
  const WorldHeight height(world.surface);
  Pose robot = world.start;
  robot.yaw_rad = radians(180.0) * one(random);
  robot.z_m = height(robot.x_m, robot.y_m);
  const test::Sampling well_seen{.half_cells = 160, .hits_per_cell = 20, .noise_m = 0.03};
  const test::Sampling once_seen{
      .hits_per_cell = 3, .noise_m = 0.03, .known_share = 0.65, .fan = true};
  const HeightMap long_term = test::sampled_map(height, Pose{}, well_seen, kCellMm, random);
  const HeightMap short_term = test::sampled_map(height, robot, once_seen, kCellMm, random);

  RegistrationPrior prior;
  prior.T_site_submap = {robot.x_m + 0.8 * one(random),
                         robot.y_m + 0.8 * one(random),
                         robot.z_m + 0.1 * one(random),
                         0.0,
                         0.0,
                         robot.yaw_rad + radians(8.0) * one(random)};
  prior.covariance = Eigen::Vector4d(0.21, 0.21, 0.01, 0.0065).asDiagonal();
  RegistrationConfig config;
  config.widen = false;
  const Registration cairn = register_map(short_term, prior, long_term, config);
  config.mode = RegistrationMode::thesis;
  const Registration thesis = register_map(short_term, prior, long_term, config);

  methods.prior.add(prior.T_site_submap, robot);
  methods.best_cell.add(thesis.best_cell, robot);
  methods.thesis.add(thesis.T_site_submap, robot);
  if (cairn.accepted) methods.cairn.add(cairn.T_site_submap, robot);
  methods.refused += cairn.accepted ? 0 : 1;
  if (!cairn.accepted) std::cerr << "seed " << seed << " refused: " << cairn.why << '\n';
}

void report_world(const std::string& name, const Methods& m, Report& report) {
  report.add({name + ", position, RMS",
              m.cairn.rms_cm(),
              "cm",
              Better::lower,
              1.0,
              {{"prior", m.prior.rms_cm()},
               {"best cell", m.best_cell.rms_cm()},
               {"thesis (T4.3.3)", m.thesis.rms_cm()}}});
  report.add({name + ", yaw, RMS",
              m.cairn.rms_deg(),
              "°",
              Better::lower,
              0.1,
              {{"prior", m.prior.rms_deg()},
               {"best cell", m.best_cell.rms_deg()},
               {"thesis (T4.3.3)", m.thesis.rms_deg()}}});
  report.add({name + ", refused of " + std::to_string(m.prior.count),
              static_cast<double>(m.refused), "", Better::lower, 0.03 * m.prior.count});
}

int run() {
  Report report("accuracy");
  for (const char* name : {"room", "hill"}) {
    Methods methods;
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kTrials / 2; ++seed) {
      const auto world = agent::make_world(name, seed);
      if (!world) {
        std::cerr << world.error().message << '\n';
        return 1;
      }
      try_once(*world, seed, methods);
    }
    report_world(name, methods, report);
  }
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main() { return cairn::bench::run(); }
