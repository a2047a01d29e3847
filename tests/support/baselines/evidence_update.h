#pragma once

#include <cstdint>

namespace cairn::baselines {

/// Ways to keep the belief that a cell is occupied (T2.2.2). Each is a type with a `Belief`, the
/// value of a cell never seen, what a hit and a pass make of it, and its probability of occupancy.

/// Recursive Bayes (T Eq. 1), in 1/255.
struct Bayes {
  using Belief = std::uint8_t;

  static constexpr Belief kUnknown = 128;
  // As the 2½-D map's sensor model: kept off certainty, so that a changed world can be learned.
  static constexpr Belief kHit = 166;
  static constexpr Belief kPass = 102;
  static constexpr Belief kLowest = 5;
  static constexpr Belief kHighest = 250;

  [[nodiscard]] static Belief after_hit(Belief belief);
  [[nodiscard]] static Belief after_pass(Belief belief);
  [[nodiscard]] static double occupied(Belief belief) { return belief / 255.0; }
};

/// Histogrammic in-motion mapping (Borenstein & Koren 1991): a counter that rises by 3 on the cell
/// of the reading, falls by 1 on the cells before it, and stays within 0 and 15.
struct Himm {
  using Belief = std::uint8_t;

  static constexpr Belief kUnknown = 0;  // It does not tell unknown from empty.
  static constexpr Belief kHighest = 15;
  static constexpr Belief kRise = 3;
  static constexpr Belief kFall = 1;

  [[nodiscard]] static Belief after_hit(Belief belief);
  [[nodiscard]] static Belief after_pass(Belief belief);
  [[nodiscard]] static double occupied(Belief belief) { return belief / 15.0; }
};

/// Masses of Dempster-Shafer theory; what is missing to 1 is mass on "either".
struct Masses {
  float occupied = 0.0F;
  float empty = 0.0F;
};

/// Dempster's rule of combination over {occupied, empty}.
/// Requires: the two do not contradict each other completely.
[[nodiscard]] Masses combine(const Masses& a, const Masses& b);

struct DempsterShafer {
  using Belief = Masses;

  static constexpr Belief kUnknown{};
  // The same strength of evidence as Bayes': p = ½ + ½ mass.
  static constexpr Belief kHit{.occupied = 0.3F};
  static constexpr Belief kPass{.empty = 0.2F};

  [[nodiscard]] static Belief after_hit(const Belief& belief) { return combine(belief, kHit); }
  [[nodiscard]] static Belief after_pass(const Belief& belief) { return combine(belief, kPass); }
  /// Half of what is left open is taken as occupied (the pignistic probability).
  [[nodiscard]] static double occupied(const Belief& belief) {
    return 0.5 + 0.5 * (double{belief.occupied} - double{belief.empty});
  }
};

}  // namespace cairn::baselines
