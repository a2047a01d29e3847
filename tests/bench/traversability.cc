// Converting a whole map (hard and soft rule, roughness, slope) against a streaming copy of what
// is read and written.
#include <cstring>
#include <iostream>

#include "core/map/soft_ground.h"
#include "tests/bench/cpu_time.h"
#include "tests/bench/planning_worlds.h"
#include "tests/bench/report.h"
#include "tests/bench/timing.h"

namespace cairn::bench {
namespace {

constexpr int kSize = 4096;
constexpr int kRuns = 5;
constexpr std::size_t kBytesRead = 5;
constexpr std::size_t kBytesWritten = 4;

/// [ns] Per cell.
double per_cell(double seconds) { return seconds * 1e9 / kSize / kSize; }

/// As much as is read, read, and as much as is written, written.
double streaming_copy_s(std::size_t cells) {
  std::vector<std::uint8_t> in(cells * kBytesRead, 1);
  std::vector<std::uint8_t> out(in.size());
  const double there_s = least_cpu_s(kRuns, [&] {
    std::memcpy(out.data(), in.data(), in.size());
    keep(out);
  });
  // A copy of n bytes reads and writes n each.
  return there_s * (kBytesRead + kBytesWritten) / (2.0 * kBytesRead);
}

int run() {
  const HeightGrid grid = planning_world("terrain", kSize, 3);
  const VehicleLimits limits;
  std::map<std::string, double> peers;
  double best_s = 0.0;
  SoftGround ground;
  std::vector<CellClass> classes;
  for (const TerrainKernels* kernels : usable_terrain_kernels()) {
    const double seconds = least_cpu_s(kRuns, [&] {
      judge(grid, limits, {}, classes, ground, *kernels);
      keep(classes);
      keep(ground);
    });
    if (best_s == 0.0) best_s = seconds;
    peers[kernels->name] = per_cell(seconds);
  }
  peers["streaming copy"] = per_cell(streaming_copy_s(grid.height_mm.size()));
  peers["hard rule alone"] = per_cell(least_cpu_s(kRuns, [&] { keep(classify(grid, limits)); }));
  Report report("traversability");
  report.add({"time per cell", per_cell(best_s), "ns", Better::lower, {}, peers});
  report.add({"speed of a streaming copy",
              peers["streaming copy"] / per_cell(best_s),
              "x",
              Better::higher,
              0.6,
              {}});
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main() { return cairn::bench::run(); }
