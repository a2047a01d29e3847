#pragma once

#include <algorithm>
#include <ctime>
#include <limits>

namespace cairn::bench {

/// [s] The least processor time of some runs of `work`, which others on the machine hardly disturb.
/// Requires: runs ≥ 1; `work` stays on this thread.
template <class Work>
[[nodiscard]] double least_cpu_s(int runs, const Work& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) {
    const std::clock_t start = std::clock();
    work();
    least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return least;
}

}  // namespace cairn::bench
