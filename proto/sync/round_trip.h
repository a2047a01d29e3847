#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/common/time.h"

namespace cairn::proto {

/// Round-trip time, estimated as in RFC 6298.
class RoundTrip {
 public:
  void measured(Duration rtt) {
    if (!smoothed_) {
      smoothed_ = rtt;
      variation_ = rtt / 2;
      return;
    }
    const Duration error = *smoothed_ > rtt ? *smoothed_ - rtt : rtt - *smoothed_;
    variation_ = (3 * variation_ + error) / 4;
    smoothed_ = (7 * *smoothed_ + rtt) / 8;
  }
  [[nodiscard]] std::optional<Duration> smoothed() const { return smoothed_; }
  /// How long to wait for an acknowledgement before a frame counts as lost.
  [[nodiscard]] Duration timeout() const {
    if (!smoothed_) return kFirstTimeout;
    return std::clamp(*smoothed_ + 4 * variation_, kMinTimeout, kMaxTimeout);
  }
  /// A long frame alone takes a second at 9.6 kbit/s.
  static constexpr Duration kFirstTimeout = std::chrono::milliseconds(2500);
  static constexpr Duration kMinTimeout = std::chrono::milliseconds(60);
  static constexpr Duration kMaxTimeout = std::chrono::seconds(30);

 private:
  std::optional<Duration> smoothed_;
  Duration variation_{};
};

}  // namespace cairn::proto
