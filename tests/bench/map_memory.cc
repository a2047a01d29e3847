// What a known cell of the long-term map costs at rest, after a lap through the room.

#include <iostream>

#include "tests/bench/packed_bytes.h"
#include "tests/bench/recorded_scans.h"
#include "tests/bench/report.h"

namespace cairn::bench {
namespace {

double bytes_per_known_cell(const HeightMap& map) {
  return packed_bytes(map) / static_cast<double>(map.known_count());
}

int run() {
  const auto scans = scans_of_room_laps(1, 1);
  if (!scans) {
    std::cerr << scans.error().message << '\n';
    return 1;
  }
  const HeightMap map = map_of(*scans, 125);
  const double dense_bytes = static_cast<double>(map.tiles().size() * sizeof(Tile));
  Report report("map_memory");
  report.add({"bytes per known cell, 125 mm cells",
              bytes_per_known_cell(map),
              "B",
              Better::lower,
              3.3,
              {{"dense tiles", dense_bytes / static_cast<double>(map.known_count())},
               {"3-D evidence grid, 20 layers (T4.2)", 20.0}}});
  report.add({"known cells",
              static_cast<double>(map.known_count()),
              "",
              Better::higher,
              std::nullopt,
              {}});
  report.print(std::cout);
  return 0;
}

}  // namespace
}  // namespace cairn::bench

int main() { return cairn::bench::run(); }
