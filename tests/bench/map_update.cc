// How fast scans become map: the rules of T4.3 against a plain loop that writes the same cells of a
// dense array without any.

#include <iostream>

#include "core/map/update.h"
#include "core/map/walk_cells.h"
#include "tests/bench/recorded_scans.h"
#include "tests/bench/report.h"
#include "tests/bench/timing.h"

namespace cairn::bench {
namespace {

constexpr int kRuns = 7;
constexpr double kCellM = 0.125;
constexpr std::int32_t kWidth = 512;  // 64 m around the origin hold the room with room to spare.

struct Counts {
  double beams = 0;
  double beam_cells = 0;
};

template <class Visit>
void walk_all(const std::vector<PlacedScan>& scans, Visit&& visit) {
  for (const PlacedScan& scan : scans) {
    for (const Beam& beam : scan.beams) {
      walk_cells(beam.origin_m.x(), beam.origin_m.y(), beam.end_m.x(), beam.end_m.y(), kCellM,
                 [&](CellIndex cell, double t) { visit(beam, cell, t); });
    }
  }
}

Counts count(const std::vector<PlacedScan>& scans) {
  Counts counts;
  for (const PlacedScan& scan : scans) counts.beams += static_cast<double>(scan.beams.size());
  walk_all(scans, [&](const Beam&, CellIndex, double) { ++counts.beam_cells; });
  return counts;
}

double plain_loop_s(const std::vector<PlacedScan>& scans) {
  struct Plain {
    std::int16_t height_mm;
    std::uint8_t probability;
  };
  std::vector<Plain> cells(std::size_t{kWidth} * kWidth);
  return shortest_run_s(kRuns, [&] {
    walk_all(scans, [&](const Beam& beam, CellIndex cell, double t) {
      const double z_m = beam.origin_m.z() + t * (beam.end_m.z() - beam.origin_m.z());
      const auto row = static_cast<std::size_t>((cell.y + kWidth / 2) & (kWidth - 1));
      const auto column = static_cast<std::size_t>((cell.x + kWidth / 2) & (kWidth - 1));
      cells[row * kWidth + column] = {static_cast<std::int16_t>(z_m * 1000.0), 166};
    });
    keep(cells);
  });
}

double rules_s(const std::vector<PlacedScan>& scans) {
  return shortest_run_s(kRuns, [&] { keep(map_of(scans, 125)); });
}

int run() {
  const auto scans = scans_of_room_laps(1, 1);
  if (!scans) {
    std::cerr << scans.error().message << '\n';
    return 1;
  }
  const Counts counts = count(*scans);
  const double rules = rules_s(*scans);
  const double plain = plain_loop_s(*scans);
  Report report("map_update");
  report.add({"beams integrated",
              counts.beams / rules,
              "1/s",
              Better::higher,
              std::nullopt,
              {{"plain loop", counts.beams / plain}}});
  report.add({"time per beam-cell",
              rules / counts.beam_cells * 1e9,
              "ns",
              Better::lower,
              std::nullopt,
              {{"plain loop", plain / counts.beam_cells * 1e9}}});
  report.add(
      {"time over that of a plain loop", rules / plain, "x", Better::lower, std::nullopt, {}});
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main() { return cairn::bench::run(); }
