// A robot that does not know where it is looks around for a few seconds and is looked for in the
// map of the whole site: how often it is found, how often somewhere else, and how long that takes.
// Places that are not in the map, and maps of other worlds, must all be refused.
//   bench_relocalize [SIGHTINGS [FIRST_SEED]]   in each block world (default 90 and 11)

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/common/angle.h"
#include "core/localization/site_search.h"
#include "robot_agent/input/noise.h"
#include "tests/bench/kidnapped.h"
#include "tests/bench/lap.h"
#include "tests/bench/report.h"

namespace cairn::bench {
namespace {

constexpr int kBlocks = 4;
constexpr double kWholeM = 0.0;
constexpr std::array<double, 4> kRadiiM = {2.0, 8.0, 20.0, kWholeM};

/// A world, its map and what robots saw in it.
struct Site {
  std::string name;
  HeightMap map{125};
  std::vector<Sighting> sightings;
};

/// What came of some searches.
struct Tally {
  int trials = 0;
  int found = 0;
  int wrong = 0;  ///< Accepted somewhere else.
  std::vector<double> seconds;
  double worst_m = 0.0;  ///< Of those found.
  std::map<std::string, int> refusals;

  [[nodiscard]] double share() const { return trials == 0 ? 0.0 : double(found) / trials; }
  [[nodiscard]] double median_s() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty() ? 0.0 : sorted[sorted.size() / 2];
  }
  [[nodiscard]] double slowest_s() const {
    return seconds.empty() ? 0.0 : *std::max_element(seconds.begin(), seconds.end());
  }
  void add(const Tally& other) {
    trials += other.trials;
    found += other.found;
    wrong += other.wrong;
    seconds.insert(seconds.end(), other.seconds.begin(), other.seconds.end());
    worst_m = std::max(worst_m, other.worst_m);
    for (const auto& [why, count] : other.refusals) refusals[why] += count;
  }
};

Result<Site> make_site(const std::string& name, std::uint64_t seed, int sightings) {
  auto world = agent::make_world(name, seed);
  if (!world) return world.error();
  const Walkable walkable(*world);
  const auto everywhere = [](double, double) { return true; };
  Site site{
      name + " " + std::to_string(seed), surveyed(*world, walkable, everywhere, seed + 500), {}};
  for (int i = 0; i < sightings; ++i) {
    auto sighting =
        put_down(*world, walkable, everywhere, seed * 10'000 + static_cast<std::uint64_t>(i));
    if (!sighting) return sighting.error();
    site.sightings.push_back(std::move(*sighting));
  }
  return site;
}

void search_once(const SiteSearch& search, const Sighting& sighting, bool in_map,
                 const std::optional<SiteDisc>& disc, Tally& tally) {
  constexpr double kFoundM = 0.5;
  const double kFoundRad = radians(5.0);
  const std::clock_t start = std::clock();
  const SiteMatch match = search.find(sighting.short_term, sighting.T_submap_robot, disc);
  tally.seconds.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  ++tally.trials;
  if (!match.accepted) {
    ++tally.refusals[match.why];
    return;
  }
  const PoseError error = error_of(match.T_site_robot, sighting.T_site_robot);
  if (in_map && error.position_m < kFoundM && error.yaw_rad < kFoundRad) {
    ++tally.found;
    tally.worst_m = std::max(tally.worst_m, error.position_m);
  } else {
    ++tally.wrong;
    std::cout << "  wrong: off by " << error.position_m << " m, " << degrees(error.yaw_rad)
              << "°; scores " << match.score_mm << ", " << match.second_best_mm << "; bounds "
              << match.bound_mm << ", " << match.second_bound_mm << '\n';
  }
}

/// A disc of this radius that holds the robot anywhere within.
std::optional<SiteDisc> disc_around(const Pose& robot, double radius_m, agent::Noise& noise) {
  if (radius_m == kWholeM) return std::nullopt;
  const double away_m = radius_m * std::sqrt(noise.uniform());
  const double angle = noise.uniform(-3.14159, 3.14159);
  return SiteDisc{robot.x_m + away_m * std::cos(angle), robot.y_m + away_m * std::sin(angle),
                  radius_m};
}

std::map<double, Tally> at_home(const Site& site) {
  const SiteSearch search(site.map);
  agent::Noise noise(site.sightings.size(), 3);
  std::map<double, Tally> by_radius;
  for (const Sighting& sighting : site.sightings) {
    for (const double radius_m : kRadiiM) {
      search_once(search, sighting, true, disc_around(sighting.T_site_robot, radius_m, noise),
                  by_radius[radius_m]);
    }
  }
  return by_radius;
}

/// The sightings of one world in the map of another.
Tally abroad(const Site& map_of, const Site& robots_of) {
  const SiteSearch search(map_of.map);
  Tally tally;
  for (const Sighting& sighting : robots_of.sightings) {
    search_once(search, sighting, false, std::nullopt, tally);
  }
  return tally;
}

/// The west of the world is mapped, the robots are far in its east.
Tally beyond_the_map(const Site& site) {
  constexpr double kMappedToM = -5.0;
  constexpr double kRobotsFromM = 18.0;
  HeightMap west(site.map.cell_size_mm());
  for (const auto& [key, tile] : site.map.tiles()) {
    for (int i = 0; i < Tile::kCells; ++i) {
      const CellIndex cell{key.tx * Tile::kSize + i % Tile::kSize,
                           key.ty * Tile::kSize + i / Tile::kSize};
      if (west.centre_m(cell.x) < kMappedToM && tile->known(i)) west.set(cell, tile->cell(i));
    }
  }
  const SiteSearch search(west);
  Tally tally;
  for (const Sighting& sighting : site.sightings) {
    if (sighting.T_site_robot.x_m < kRobotsFromM) continue;
    search_once(search, sighting, false, std::nullopt, tally);
  }
  return tally;
}

void print(const std::string& what, const Tally& tally) {
  std::cout << what << ": " << tally.trials << " trials, found " << 100.0 * tally.share()
            << " %, wrong " << tally.wrong << ", median " << tally.median_s() << " s, slowest "
            << tally.slowest_s() << " s, worst " << tally.worst_m << " m\n";
  for (const auto& [why, count] : tally.refusals) {
    std::cout << "    " << count << " × " << why << '\n';
  }
  std::cout << std::flush;
}

std::string name_of(double radius_m) {
  return radius_m == kWholeM ? "whole site"
                             : "±" + std::to_string(static_cast<int>(radius_m)) + " m";
}

/// All kinds of trials of all worlds.
struct Totals {
  std::map<std::string, std::map<double, Tally>> home;  ///< By kind of world and radius.
  Tally foreign;
};

void try_site(const Site& site, const std::string& kind, Totals& totals) {
  for (const auto& [radius_m, tally] : at_home(site)) totals.home[kind][radius_m].add(tally);
  print(site.name + ", so far, whole site", totals.home[kind][kWholeM]);
}

Report report_of(const Totals& totals) {
  Report report("relocalize");
  int wrong = totals.foreign.wrong;
  int trials = totals.foreign.trials;
  double slowest_s = totals.foreign.slowest_s();
  for (const auto& [kind, by_radius] : totals.home) {
    for (const auto& [radius_m, tally] : by_radius) {
      print(kind + ", " + name_of(radius_m), tally);
      const bool asked = kind == "block" && radius_m == kWholeM;
      report.add({"found, " + kind + ", " + name_of(radius_m), 100.0 * tally.share(), "%",
                  Better::higher, asked ? std::optional(95.0) : std::nullopt});
      report.add({"time, " + kind + ", " + name_of(radius_m), tally.median_s(), "s"});
      wrong += tally.wrong;
      trials += tally.trials;
      slowest_s = std::max(slowest_s, tally.slowest_s());
    }
  }
  print("not in the map", totals.foreign);
  report.add({"found wrongly", 100.0 * wrong / trials, "%", Better::lower, 0.1});
  report.add({"trials", static_cast<double>(trials), "", Better::higher, 1000.0});
  report.add({"of these not in the map", static_cast<double>(totals.foreign.trials), ""});
  report.add({"slowest search", slowest_s, "s", Better::lower, 2.0});
  return report;
}

int run(int sightings, std::uint64_t first_seed) {
  std::vector<Site> blocks;
  Totals totals;
  for (std::uint64_t seed = first_seed; seed < first_seed + kBlocks; ++seed) {
    auto site = make_site("block", seed, sightings);
    if (!site) return 1;
    try_site(*site, "block", totals);
    totals.foreign.add(beyond_the_map(*site));
    blocks.push_back(std::move(*site));
  }
  for (const Site& map_of : blocks) {
    for (const Site& robots_of : blocks) {
      if (&map_of != &robots_of) totals.foreign.add(abroad(map_of, robots_of));
    }
  }
  for (const std::string kind : {"hill", "room"}) {
    auto site = make_site(kind, first_seed, sightings / 2);
    if (!site) return 1;
    try_site(*site, kind, totals);
    totals.foreign.add(abroad(blocks.front(), *site));
    totals.foreign.add(abroad(*site, blocks.front()));
  }
  report_of(totals).print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main(int argc, char** argv) {
  const int sightings = argc > 1 ? std::atoi(argv[1]) : 90;
  const int first_seed = argc > 2 ? std::atoi(argv[2]) : 11;
  if (sightings < 2 || first_seed < 1) {
    std::cerr << "bench_relocalize [SIGHTINGS ≥ 2 [FIRST_SEED ≥ 1]]\n";
    return 2;
  }
  return cairn::bench::run(sightings, static_cast<std::uint64_t>(first_seed));
}
