#pragma once

#include <optional>
#include <vector>

#include "core/common/time.h"

namespace cairn::agent {

/// Makes a time that starts at 0 and never goes back out of a log's stamps.
class LogClock {
 public:
  static constexpr double kReorderS = 2.0;     ///< Readings up to this late are put in order.
  static constexpr double kLongestGapS = 600;  ///< A longer pause is a jump of the clock.
  static constexpr double kStepS = 0.1;        ///< What a jump, or a reading without stamp, counts.

  /// `first_stamps_s`: how the log begins. Without usable stamps among them (fewer than half go on
  /// by more than 0 and at most kLongestGapS) readings are taken as kStepS apart.
  explicit LogClock(const std::vector<double>& first_stamps_s);

  /// The time of the next reading in the file; up to kReorderS before one returned earlier.
  [[nodiscard]] MonotonicTime time_of(double stamp_s);
  /// No reading to come is earlier than this.
  [[nodiscard]] MonotonicTime settled() const;

 private:
  bool usable_;
  double offset_s_ = 0.0;  ///< Log time of stamp 0.
  double latest_s_ = 0.0;
  bool started_ = false;
};

}  // namespace cairn::agent
