#pragma once

#include <cstdint>
#include <string>

#include "core/map/cell.h"

namespace cairn {

/// How finely a map travels: heights are whole multiples of a quantum, probabilities one of a few
/// levels that lie evenly in log odds. What is written coarsely at the source is the same at both
/// ends.
struct Coarseness {
  /// [mm] Heights are multiples of it. [Limit: 1 … 255]
  int quantum_mm = 10;
  /// Probability levels between the model's least and most, or kExactProbability.
  /// [Limit: 2 … 16, or 0]
  int levels = 16;

  friend bool operator==(const Coarseness&, const Coarseness&) = default;
};
inline constexpr int kExactProbability = 0;
inline constexpr int kMaxLevels = 16;
/// Nothing is rounded.
inline constexpr Coarseness kExact{1, kExactProbability};

/// Every fault in one sentence each, joined by "; ". Empty when it is sound.
[[nodiscard]] std::string faults(const Coarseness& coarseness);

/// [1/255] The ends of the levels: as the sensor model's (T4.3).
inline constexpr std::uint8_t kLeastLevel = 25;
inline constexpr std::uint8_t kMostLevel = 250;

/// The probability [1/255] that a level stands for. Requires: 2 ≤ levels ≤ 16, 0 ≤ level < levels.
[[nodiscard]] std::uint8_t probability_of(int level, int levels);
/// The level nearest to a probability. Requires: 2 ≤ levels ≤ 16, probability ≥ 1.
[[nodiscard]] int level_of(std::uint8_t probability, int levels);

/// Whether the cell's values are among those of this coarseness. Certainty (255) always is.
[[nodiscard]] bool representable(const Cell& cell, const Coarseness& coarseness);

/// What is told of a cell that now has these exact values, given what was told of it before. Values
/// that moved by less than a quantum, or less than a level, are not told again: a mean that settles
/// or wanders in the sensor's noise is no news. Unknown stays unknown, certainty certainty.
[[nodiscard]] Cell coarse(const Cell& exact, const Cell& told, const Coarseness& coarseness);

}  // namespace cairn
