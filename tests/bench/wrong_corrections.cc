// How often registration is fooled: 2,000 maps (or --trials N) in rooms, blocks and on hills, of
// which 30 % are corrupted or come from a wrong place (T5.3 asks for localization that detects a
// bad correction).
//
// A correction is wrong when it was accepted and the robot is farther from where it is said to be
// than 4 σ of the answer's covariance and than 0.15 m (a cell and a bit; paths keep more than that
// from obstacles), or than 4 σ and 2°. An answer that leaves the prior as it was, with the prior's
// covariance, is right by that measure; one that claims to know more must be.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
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

constexpr int kCellMm = 125;
constexpr int kTrialsPerWorld = 50;
constexpr std::uint64_t kFirstSeed = 7000;

/// What is done to a short-term map.
enum class Fault { none, displaced_part, mirrored, noise, wrong_place, other_world };
constexpr const char* kFaultNames[] = {"good",  "displaced part", "mirrored",
                                       "noise", "wrong place",    "another world"};

struct Tally {
  int tried = 0;
  int accepted = 0;
  int wrong = 0;
};

using Random = std::mt19937_64;

double one(Random& random) { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); }

Fault any_fault(Random& random) {
  if (std::bernoulli_distribution(0.7)(random)) return Fault::none;
  return static_cast<Fault>(std::uniform_int_distribution<int>(1, 5)(random));
}

/// Calls visit(index, cell) for every known cell.
template <class Visit>
void for_each_cell(const HeightMap& map, const Visit& visit) {
  for (const auto& [key, tile] : map.tiles()) {
    for (int i = 0; i < Tile::kCells; ++i) {
      if (!tile->known(i)) continue;
      const CellIndex at{key.tx * Tile::kSize + i % Tile::kSize,
                         key.ty * Tile::kSize + i / Tile::kSize};
      visit(at, map.cell(at));
    }
  }
}

/// 10 to 40 % of the map, all on one side, are moved by up to a metre and lifted: as when a wheel
/// slipped midway.
HeightMap with_displaced_part(const HeightMap& map, Random& random) {
  const double angle = radians(180.0) * one(random);
  const auto along = [&](CellIndex at) { return std::cos(angle) * at.x + std::sin(angle) * at.y; };
  std::vector<double> all;
  for_each_cell(map, [&](CellIndex at, const Cell&) { all.push_back(along(at)); });
  std::sort(all.begin(), all.end());
  const double stays = 0.75 + 0.15 * one(random);
  const double edge = all[static_cast<std::size_t>(stays * static_cast<double>(all.size() - 1))];
  const CellIndex by{static_cast<std::int32_t>(std::lround(8.0 * one(random))),
                     static_cast<std::int32_t>(std::lround(8.0 * one(random)))};
  const auto up_mm = static_cast<std::int32_t>(std::lround(200.0 * one(random)));
  HeightMap faulty(map.cell_size_mm());
  for_each_cell(map, [&](CellIndex at, Cell cell) {
    const bool moved = along(at) > edge;
    if (moved) cell.height_mm += up_mm;
    faulty.set(moved ? CellIndex{at.x + by.x, at.y + by.y} : at, cell);
  });
  return faulty;
}

HeightMap mirrored(const HeightMap& map) {
  HeightMap faulty(map.cell_size_mm());
  for_each_cell(map, [&](CellIndex at, const Cell& cell) { faulty.set({at.x, -1 - at.y}, cell); });
  return faulty;
}

HeightMap with_noise(const HeightMap& map, Random& random) {
  HeightMap faulty(map.cell_size_mm());
  std::normal_distribution<double> noise_mm(0.0, 50.0 + 100.0 * (1.0 + one(random)));
  for_each_cell(map, [&](CellIndex at, Cell cell) {
    cell.height_mm += static_cast<std::int32_t>(std::lround(noise_mm(random)));
    faulty.set(at, cell);
  });
  return faulty;
}

/// A world with a long-term map of it, made once for many registrations.
struct Place {
  agent::World world;
  HeightMap long_term{kCellMm};

  Place(agent::World made, Random& random) : world(std::move(made)) {
    long_term = test::sampled_map(WorldHeight(world.surface), Pose{},
                                  {.half_cells = 200, .hits_per_cell = 8, .noise_m = 0.03}, kCellMm,
                                  random);
  }

  /// Somewhere near the start.
  [[nodiscard]] Pose somewhere(Random& random) const {
    const WorldHeight height(world.surface);
    const double reach_m = world.name == "room" ? 3.0 : 8.0;
    while (true) {
      Pose robot = world.start;
      robot.x_m += reach_m * one(random);
      robot.y_m += reach_m * one(random);
      robot.z_m = height(robot.x_m, robot.y_m);
      robot.yaw_rad = radians(180.0) * one(random);
      if (std::isfinite(robot.z_m) && robot.z_m < 2.0) return robot;
    }
  }

  [[nodiscard]] HeightMap seen_from(const Pose& robot, Random& random) const {
    return test::sampled_map(
        WorldHeight(world.surface), robot,
        {.half_cells = 48, .hits_per_cell = 3, .noise_m = 0.03, .known_share = 0.65, .fan = true},
        kCellMm, random);
  }
};

/// With a margin for the prior's error. There a map of elsewhere would rightly be found.
bool within_the_wide_window(const Pose& a, const Pose& b) {
  return std::max(std::abs(a.x_m - b.x_m), std::abs(a.y_m - b.y_m)) < 5.5 &&
         std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) < radians(45.0);
}

HeightMap short_term_map(Fault fault, const Pose& robot, const Place& here, const Place& other,
                         Random& random) {
  if (fault == Fault::other_world) return other.seen_from(other.somewhere(random), random);
  if (fault == Fault::wrong_place) {
    Pose elsewhere = here.somewhere(random);
    while (within_the_wide_window(elsewhere, robot)) elsewhere = here.somewhere(random);
    return here.seen_from(elsewhere, random);
  }
  const HeightMap map = here.seen_from(robot, random);
  if (fault == Fault::displaced_part) return with_displaced_part(map, random);
  if (fault == Fault::mirrored) return mirrored(map);
  return fault == Fault::noise ? with_noise(map, random) : map;
}

bool is_wrong(const Registration& answer, const Pose& robot) {
  constexpr double kSigmas = 4.0;
  const Pose& found = answer.T_site_robot;
  const double off_m = std::hypot(found.x_m - robot.x_m, found.y_m - robot.y_m);
  const double off_rad = std::abs(wrap_angle(found.yaw_rad - robot.yaw_rad));
  const double sigma_m = std::sqrt(answer.covariance.topLeftCorner<2, 2>().trace());
  const double sigma_rad = std::sqrt(answer.covariance(3, 3));
  return off_m > std::max(0.15, kSigmas * sigma_m) ||
         off_rad > std::max(radians(2.0), kSigmas * sigma_rad);
}

/// The prior is off as its covariance says: 0.3 m and 3°, and twice that now and then.
RegistrationPrior prior_near(const Pose& robot, Random& random) {
  constexpr double kSigmaM = 0.3;
  const double sigma_rad = radians(3.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  RegistrationPrior prior;
  prior.T_site_submap = {robot.x_m + kSigmaM * normal(random),
                         robot.y_m + kSigmaM * normal(random),
                         robot.z_m + 0.05 * normal(random),
                         0.0,
                         0.0,
                         wrap_angle(robot.yaw_rad + sigma_rad * normal(random))};
  prior.covariance =
      Eigen::Vector4d(kSigmaM * kSigmaM, kSigmaM * kSigmaM, 0.0025, sigma_rad * sigma_rad)
          .asDiagonal();
  return prior;
}

class Trials {
 public:
  void try_once(const Place& here, const Place& other, std::uint64_t seed) {
    Random random(seed);
    const Pose robot = here.somewhere(random);
    const Fault fault = any_fault(random);
    const HeightMap map = short_term_map(fault, robot, here, other, random);
    const Registration answer =
        register_map(map, prior_near(robot, random), here.long_term, RegistrationConfig{});
    Tally& tally = tallies_[fault];
    ++tally.tried;
    if (!answer.accepted) {
      if (fault == Fault::none) ++reasons_[answer.why];
      return;
    }
    ++tally.accepted;
    if (!is_wrong(answer, robot)) return;
    ++tally.wrong;
    const Pose& found = answer.T_site_robot;
    std::cerr << "wrong: " << kFaultNames[static_cast<int>(fault)] << " in " << here.world.name
              << ", seed " << seed << ": off by "
              << std::hypot(found.x_m - robot.x_m, found.y_m - robot.y_m) << " m, "
              << degrees(wrap_angle(found.yaw_rad - robot.yaw_rad)) << "°, overlap "
              << answer.overlap << ", inliers " << answer.inliers << ", residual "
              << answer.residual_mm << " mm, misfit " << answer.misfit << ", margin "
              << answer.margin << ", distinctness " << answer.distinctness
              << (answer.wide ? ", wide" : "") << ", sigma " << std::sqrt(answer.covariance(0, 0))
              << " m, innovation " << answer.innovation << '\n';
  }

  void report(Report& report) const {
    int wrong = 0;
    for (const auto& [fault, tally] : tallies_) {
      wrong += tally.wrong;
      const std::string name = kFaultNames[static_cast<int>(fault)];
      report.add({name + ": accepted of " + std::to_string(tally.tried),
                  static_cast<double>(tally.accepted)});
    }
    for (const auto& [why, count] : reasons_) {
      std::cout << "good ones refused: " << count << " × " << why << '\n';
    }
    const Tally& good = tallies_.at(Fault::none);
    report.add({"wrong corrections accepted", static_cast<double>(wrong), "", Better::lower, 0.0});
    report.add({"good ones refused", 100.0 * (good.tried - good.accepted) / good.tried, "%",
                Better::lower, 3.0});
  }

 private:
  std::map<Fault, Tally> tallies_;
  std::map<std::string, int> reasons_;
};

/// Worlds in turn, so that fewer trials see all kinds too.
int run(int trials) {
  const std::vector<std::string> names{"room", "block", "hill"};
  Trials all;
  std::vector<Place> places;
  for (int first = 0; first < trials; first += kTrialsPerWorld) {
    const std::uint64_t seed = kFirstSeed + static_cast<std::uint64_t>(first);
    auto world =
        agent::make_world(names[static_cast<std::size_t>(first / kTrialsPerWorld) % 3], seed);
    if (!world) {
      std::cerr << world.error().message << '\n';
      return 1;
    }
    Random random(seed);
    places.emplace_back(std::move(*world), random);
    const Place& other = places.size() > 1 ? places[places.size() - 2] : places.back();
    for (int i = 0; i < std::min(kTrialsPerWorld, trials - first); ++i) {
      all.try_once(places.back(), other, seed + static_cast<std::uint64_t>(i));
    }
    if (places.size() > 1) places.erase(places.begin());
  }
  Report report("wrong_corrections");
  all.report(report);
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  const bool counted = argc == 3 && std::string(argv[1]) == "--trials";
  const int trials = counted ? std::atoi(argv[2]) : 2'000;
  if ((argc > 1 && !counted) || trials < 10 || trials > 1'000'000) {
    std::cerr << "usage: " << argv[0] << " [--trials N], N from 10 to 1,000,000\n";
    return 2;
  }
  return cairn::bench::run(trials);
}
