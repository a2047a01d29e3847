#include "robot_agent/input/log_clock.h"

#include <algorithm>
#include <cstddef>

namespace cairn::agent {
namespace {

bool are_usable(const std::vector<double>& stamps_s) {
  std::size_t forward = 0;
  for (std::size_t i = 1; i < stamps_s.size(); ++i) {
    const double gap = stamps_s[i] - stamps_s[i - 1];
    forward += gap > 0.0 && gap <= LogClock::kLongestGapS ? 1 : 0;
  }
  return 2 * forward >= stamps_s.size() - std::min<std::size_t>(stamps_s.size(), 1);
}

// Stamps of 1e9 s have no exact microseconds: to the nearest.
MonotonicTime rounded(double time_s) { return from_seconds(time_s + 0.5e-6); }

}  // namespace

LogClock::LogClock(const std::vector<double>& first_stamps_s)
    : usable_(are_usable(first_stamps_s)) {}

MonotonicTime LogClock::time_of(double stamp_s) {
  const double time_s = stamp_s + offset_s_;
  const bool late = time_s < latest_s_ - kReorderS;
  const bool jumps = !started_ || !usable_ || late || time_s > latest_s_ + kLongestGapS;
  if (jumps) {
    latest_s_ += started_ ? kStepS : 0.0;
    offset_s_ = latest_s_ - stamp_s;
    started_ = true;
    return rounded(latest_s_);
  }
  latest_s_ = std::max(latest_s_, time_s);
  return rounded(std::max(time_s, 0.0));
}

MonotonicTime LogClock::settled() const {
  return from_seconds(usable_ ? latest_s_ - kReorderS : latest_s_);
}

}  // namespace cairn::agent
