#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace cairn::agent {

/// A stream of random numbers that is the same with every standard library: the engine is defined
/// by the standard, the distributions of <random> are not.
class Noise {
 public:
  /// Streams of one seed with different numbers are independent of each other.
  Noise(std::uint64_t seed, std::uint64_t stream)
      : engine_(mix(seed * 0x9E3779B97F4A7C15U + stream)) {}

  /// In [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1.0p-53; }
  double uniform(double from, double to) { return from + (to - from) * uniform(); }
  /// In 0 … count - 1. Requires: count ≥ 1.
  int below(int count) { return static_cast<int>(uniform() * count); }
  /// -1 or 1.
  double sign() { return uniform() < 0.5 ? -1.0 : 1.0; }

  /// Mean 0, standard deviation 1 (Box and Muller, 1958).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

  /// Spreads seeds that differ in one bit (splitmix64, Steele et al. 2014).
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace cairn::agent
