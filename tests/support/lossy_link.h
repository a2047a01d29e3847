#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "core/common/time.h"

namespace cairn::testing {

/// What a link does to frames.
struct LinkFaults {
  double loss = 0.0;       ///< [0 … 1]
  double duplicate = 0.0;  ///< [0 … 1]
  Duration least_delay = std::chrono::milliseconds(20);
  Duration most_delay = std::chrono::milliseconds(20);  ///< A wide span reorders.
};

/// One direction of a link in memory: loses, doubles, delays and reorders frames as its seed says.
class LossyLink {
 public:
  using Bytes = std::vector<std::uint8_t>;

  LossyLink(std::uint64_t seed, LinkFaults faults) : random_(seed), faults_(faults) {}

  void set_faults(LinkFaults faults) { faults_ = faults; }

  void send(const Bytes& bytes, MonotonicTime now) {
    ++frames_;
    if (!chance(faults_.loss)) on_the_way_.emplace(now + delay(), bytes);
    if (chance(faults_.duplicate)) on_the_way_.emplace(now + delay(), bytes);
  }
  /// The next frame that has arrived by `now`.
  std::optional<Bytes> receive(MonotonicTime now) {
    if (on_the_way_.empty() || on_the_way_.begin()->first > now) return std::nullopt;
    return std::move(on_the_way_.extract(on_the_way_.begin()).mapped());
  }
  [[nodiscard]] std::optional<MonotonicTime> next_arrival() const {
    if (on_the_way_.empty()) return std::nullopt;
    return on_the_way_.begin()->first;
  }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }  ///< Ever sent.

 private:
  bool chance(double p) { return std::bernoulli_distribution(p)(random_); }
  Duration delay() {
    return Duration(std::uniform_int_distribution<Duration::rep>(
        faults_.least_delay.count(), faults_.most_delay.count())(random_));
  }

  std::mt19937_64 random_;
  LinkFaults faults_;
  std::multimap<MonotonicTime, Bytes> on_the_way_;
  std::uint64_t frames_ = 0;
};

}  // namespace cairn::testing
