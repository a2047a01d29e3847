#pragma once

#include <algorithm>
#include <chrono>
#include <limits>

namespace cairn::bench {

/// [s] The shortest of some runs of `work`: what it takes when nothing else disturbs.
/// Requires: runs ≥ 1.
template <class Work>
[[nodiscard]] double shortest_run_s(int runs, const Work& work) {
  using Clock = std::chrono::steady_clock;
  double shortest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) {
    const Clock::time_point start = Clock::now();
    work();
    shortest = std::min(shortest, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return shortest;
}

/// Makes the compiler believe that somebody looks at `value`.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

}  // namespace cairn::bench
