#pragma once

#include <chrono>

namespace cairn {

/// Time since an arbitrary but fixed start; who owns the clock passes it in. Never wall time.
using MonotonicTime = std::chrono::microseconds;
using Duration = std::chrono::microseconds;

[[nodiscard]] inline double to_seconds(Duration d) {
  return std::chrono::duration<double>(d).count();
}
[[nodiscard]] inline Duration from_seconds(double s) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s));
}

}  // namespace cairn
