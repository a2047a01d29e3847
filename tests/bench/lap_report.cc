#include "tests/bench/lap_report.h"

#include <algorithm>
#include <cstring>
#include <iostream>

#include "core/common/angle.h"

namespace cairn::bench {
namespace {

constexpr int kSeeds = 20;

/// Mean and worst of a number.
struct Spread {
  double sum = 0.0;
  double worst = 0.0;
  int count = 0;

  void add(double value) {
    sum += value;
    worst = std::max(worst, value);
    ++count;
  }
  [[nodiscard]] double mean() const { return sum / count; }
};

struct Ends {
  Spread position_m, z_m, yaw_deg;

  void add(const PoseError& error) {
    position_m.add(error.position_m);
    z_m.add(error.z_m);
    yaw_deg.add(degrees(error.yaw_rad));
  }
};

struct Laps {
  Ends corrected, uncorrected;
  Ends on_the_way;  ///< Corrected, at every reading.
  std::uint64_t corrections = 0;
  std::uint64_t refusals = 0;
  int lost = 0;

  void add(const Lap& lap) {
    corrected.add(error_of(lap.corrected.back(), lap.truth.back()));
    uncorrected.add(error_of(lap.uncorrected.back(), lap.truth.back()));
    for (std::size_t i = 0; i < lap.truth.size(); ++i) {
      on_the_way.add(error_of(lap.corrected[i], lap.truth[i]));
    }
    corrections += lap.corrections;
    refusals += lap.refusals;
    lost += lap.lost ? 1 : 0;
  }
};

void print_lap(std::uint64_t seed, const Lap& lap) {
  const PoseError with = error_of(lap.corrected.back(), lap.truth.back());
  const PoseError without = error_of(lap.uncorrected.back(), lap.truth.back());
  std::cout << "seed " << seed << ": corrected " << with.position_m << " m, z " << with.z_m
            << " m, " << degrees(with.yaw_rad) << "°; uncorrected " << without.position_m
            << " m, z " << without.z_m << " m, " << degrees(without.yaw_rad) << "°; "
            << lap.corrections << " corrections, " << lap.refusals << " refused"
            << (lap.last_refusal.empty() ? "" : " (" + lap.last_refusal + ")") << std::endl;
}

void add_figures(const Laps& laps, const LapGoals& goals, Report& report) {
  const Ends& with = laps.corrected;
  const Ends& without = laps.uncorrected;
  const auto add = [&](const char* name, double value, const char* unit, double goal, double peer) {
    report.add({name, value, unit, Better::lower, goal, {{"uncorrected", peer}}});
  };
  add("position at the end, mean", with.position_m.mean(), "m", goals.mean_m,
      without.position_m.mean());
  add("position at the end, worst", with.position_m.worst, "m", goals.worst_m,
      without.position_m.worst);
  add("yaw at the end, mean", with.yaw_deg.mean(), "°", degrees(goals.mean_rad),
      without.yaw_deg.mean());
  add("yaw at the end, worst", with.yaw_deg.worst, "°", degrees(goals.worst_rad),
      without.yaw_deg.worst);
  if (goals.with_z) {
    add("z at the end, mean", with.z_m.mean(), "m", goals.mean_m, without.z_m.mean());
    add("z at the end, worst", with.z_m.worst, "m", goals.worst_m, without.z_m.worst);
    report.add({"z on the way, worst", laps.on_the_way.z_m.worst, "m"});
  }
  report.add({"position on the way, mean", laps.on_the_way.position_m.mean(), "m"});
  report.add({"position on the way, worst", laps.on_the_way.position_m.worst, "m"});
  report.add({"corrections", static_cast<double>(laps.corrections), "", Better::higher});
  report.add({"refused", static_cast<double>(laps.refusals)});
  report.add({"laps lost", static_cast<double>(laps.lost), "", Better::lower, 0.0});
}

}  // namespace

int run_laps(const std::string& bench, const std::string& world, const std::vector<WayPoint>& way,
             const LapGoals& goals, int argc, char** argv) {
  const std::string png = argc == 3 && std::strcmp(argv[1], "--png") == 0 ? argv[2] : "";
  if (argc > 1 && png.empty()) {
    std::cerr << "usage: " << argv[0] << " [--png FILE]\n";
    return 2;
  }
  Laps laps;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto map = map_from_true_poses(world, seed, way);
    const auto lap = map ? drive_lap(world, seed, way, *map) : Result<Lap>(map.error());
    if (!lap) {
      std::cerr << lap.error().message << '\n';
      return 1;
    }
    print_lap(seed, *lap);
    laps.add(*lap);
    if (seed != 1 || png.empty()) continue;
    if (const Status drawn = draw(*map, *lap, png); !drawn)
      std::cerr << drawn.error().message << '\n';
  }
  Report report(bench);
  add_figures(laps, goals, report);
  report.print(std::cout);
  return 0;
}

}  // namespace cairn::bench
