// One lap of the 13 × 13 m room on its long-term map (T4.3.3, Figs. 16-17). The thesis ended it
// 0.047 m and 1° off, from 0.693 m and 6° uncorrected.

#include "core/common/angle.h"
#include "tests/bench/lap_report.h"

int main(int argc, char** argv) {
  using cairn::radians;
  return cairn::bench::run_laps(
      "room_lap", "room", {{10.5, 2.5}, {10.5, 10.5}, {2.5, 10.5}, {2.5, 2.5}},
      {.mean_m = 0.02, .mean_rad = radians(0.2), .worst_m = 0.047, .worst_rad = radians(1.0)}, argc,
      argv);
}
