// Up the ramp, around the platform and down again: the experiment that the thesis could not make
// (T5.1).

#include "core/common/angle.h"
#include "tests/bench/lap_report.h"

int main(int argc, char** argv) {
  using cairn::radians;
  return cairn::bench::run_laps(
      "ramp_lap", "ramp",
      {{10.0, 10.3}, {19.5, 10.3}, {24.3, 10.0}, {24.3, 8.2}, {19.5, 9.3}, {10.0, 9.3}, {4.0, 8.5}},
      {.mean_m = 0.05,
       .mean_rad = radians(0.3),
       .worst_m = 0.05,
       .worst_rad = radians(0.3),
       .with_z = true},
      argc, argv);
}
