#pragma once

#include <cstddef>
#include <optional>

#include "core/localization/search.h"

namespace cairn {

/// A box of candidates around one, which a search leaves out.
struct Excluded {
  Candidate centre;
  int cells = 0;
  int turns = 0;

  [[nodiscard]] bool holds(int yaw, int y, int x) const;
};

/// What a wide search found and what it cost.
struct WideMatch {
  std::optional<Candidate> best;  ///< Empty when no candidate beats the limit.
  std::size_t bounds = 0;         ///< Evaluated bounds, those of single candidates included.
};

/// The best candidate of the whole window, exactly as `search_all` would find it, by branch and
/// bound: blocks of shifts are tried together against the lowest and highest heights that any of
/// their shifts meets, which bounds every score in them from below; only the promising ones are
/// divided. Candidates that score `limit_mm` or more do not count.
[[nodiscard]] WideMatch search_wide(const MatchProblem& problem, const MatchKernels& kernels,
                                    double limit_mm, const std::optional<Excluded>& excluded);

}  // namespace cairn
