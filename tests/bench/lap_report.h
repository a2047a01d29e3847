#pragma once

#include <string>
#include <vector>

#include "tests/bench/lap.h"
#include "tests/bench/report.h"

namespace cairn::bench {

/// What a lap must reach.
struct LapGoals {
  double mean_m;
  double mean_rad;
  double worst_m;
  double worst_rad;
  bool with_z = false;
};

/// Drives a lap for each of 20 seeds and prints the errors at its end, corrected and uncorrected.
/// With --png FILE the first lap is drawn. Returns the program's exit code.
int run_laps(const std::string& bench, const std::string& world, const std::vector<WayPoint>& way,
             const LapGoals& goals, int argc, char** argv);

}  // namespace cairn::bench
