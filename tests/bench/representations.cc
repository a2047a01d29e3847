// T4.2's comparison: a 2-D and a 3-D evidence grid and the 2½-D map, on the same lap through the
// room. The flat grid can only use the level laser.

#include <iostream>

#include "tests/bench/packed_bytes.h"
#include "tests/bench/recorded_scans.h"
#include "tests/bench/report.h"
#include "tests/bench/timing.h"
#include "tests/support/baselines/evidence_grid_2d.h"
#include "tests/support/baselines/evidence_grid_3d.h"

namespace cairn::bench {
namespace {

constexpr int kRuns = 5;
constexpr std::size_t kLevelLaser = 0;
// 16 × 16 m in 0.125 m cells, as in the thesis, with the room in the middle.
const baselines::GridExtent kRoom{.origin = {-12, -12}, .width = 128, .height = 128};

struct Cost {
  double bytes = 0.0;
  double ns_per_beam = 0.0;
};

double beams_in(const std::vector<PlacedScan>& scans) {
  double beams = 0.0;
  for (const PlacedScan& scan : scans) beams += static_cast<double>(scan.beams.size());
  return beams;
}

template <class MakeGrid>
Cost cost_of_grid(const std::vector<PlacedScan>& scans, const MakeGrid& make_grid) {
  const double time_s = shortest_run_s(kRuns, [&] {
    auto grid = make_grid();
    for (const PlacedScan& scan : scans) grid.integrate(scan.beams);
    keep(grid);
  });
  return {static_cast<double>(make_grid().bytes()), time_s / beams_in(scans) * 1e9};
}

Cost cost_of_height_map(const std::vector<PlacedScan>& scans) {
  const double time_s = shortest_run_s(kRuns, [&] { keep(map_of(scans, 125)); });
  return {packed_bytes(map_of(scans, 125)), time_s / beams_in(scans) * 1e9};
}

std::vector<PlacedScan> of_level_laser(const std::vector<PlacedScan>& scans) {
  std::vector<PlacedScan> level;
  for (const PlacedScan& scan : scans) {
    if (scan.laser == kLevelLaser) level.push_back(scan);
  }
  return level;
}

int run() {
  const auto scans = scans_of_room_laps(1, 1);
  if (!scans) {
    std::cerr << scans.error().message << '\n';
    return 1;
  }
  const Cost flat = cost_of_grid(of_level_laser(*scans),
                                 [] { return baselines::EvidenceGrid2d<baselines::Bayes>(kRoom); });
  const Cost solid = cost_of_grid(*scans, [] { return baselines::EvidenceGrid3d(kRoom, -2); });
  const Cost ours = cost_of_height_map(*scans);

  Report report("representations");
  report.add({"memory of the room",
              ours.bytes,
              "B",
              Better::lower,
              std::nullopt,
              {{"2-D evidence grid", flat.bytes}, {"3-D evidence grid", solid.bytes}}});
  report.add({"memory over that of the 3-D grid",
              ours.bytes / solid.bytes,
              "x",
              Better::lower,
              3.3 / baselines::EvidenceGrid3d::kLayers,
              {}});
  report.add({"update time per beam",
              ours.ns_per_beam,
              "ns",
              Better::lower,
              std::nullopt,
              {{"2-D evidence grid", flat.ns_per_beam}, {"3-D evidence grid", solid.ns_per_beam}}});
  report.add({"update time over that of the 3-D grid",
              ours.ns_per_beam / solid.ns_per_beam,
              "x",
              Better::lower,
              1.0,
              {}});
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main() { return cairn::bench::run(); }
