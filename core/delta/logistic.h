#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace cairn {

/// Probabilities and their log odds in whole numbers, so that both ends of a link mean the same to
/// the bit on every machine, with every compiler.

/// Log odds are counted in this part of a nat …
inline constexpr int kLogitUnit = 256;
/// … and end here on both sides: probabilities from 1 in 2981 to all but that.
inline constexpr int kLogitLimit = 2047;

namespace logistic {
inline constexpr std::size_t kStretchSteps = 4096;
extern const std::array<std::uint16_t, 2 * kLogitLimit + 1> kSquash;
extern const std::array<std::int16_t, kStretchSteps> kStretch;
}  // namespace logistic

/// The probability [1/65536] of these log odds [1/256 nat]; beyond the limit it is the limit's.
[[nodiscard]] inline int squash(int logit) {
  const int at = std::clamp(logit, -kLogitLimit, kLogitLimit) + kLogitLimit;
  return logistic::kSquash[static_cast<std::size_t>(at)];
}

/// The log odds [1/256 nat] of a probability [1/65536]. Requires: 0 ≤ probability < 65536.
[[nodiscard]] inline int stretch(int probability) {
  return logistic::kStretch[static_cast<std::size_t>(probability) >> 4U];
}

}  // namespace cairn
