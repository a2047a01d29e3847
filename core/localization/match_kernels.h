#pragma once

#include <cstdint>

#include "core/localization/turned_map.h"

namespace cairn {

/// [mm] A height difference counts at most this much: something moved, or only one map saw it.
inline constexpr int kTruncateMm = 500;

/// What a turned map says at one shift.
struct MatchSum {
  std::uint32_t difference_mm = 0;  ///< Sum of |height difference|, each truncated.
  std::uint32_t overlap = 0;        ///< Cells known in both.
  friend bool operator==(const MatchSum&, const MatchSum&) = default;
};

/// The inner loops of registration, in one instruction set. All sets give the same integers.
struct MatchKernels {
  const char* name;
  /// Sums at side × side neighbouring shifts, x fastest; `long_term` points at the first one's
  /// raster, which is `width` wide.
  void (*square)(const TurnedMap& turned, const std::int16_t* long_term, int width, int side,
                 MatchSum* sums);
  /// The same at one place for a map of which only the lowest and highest height of each cell are
  /// known: a lower bound of the difference. Differences within [lowest, highest] count 0.
  MatchSum (*bound)(const TurnedMap& turned, const std::int16_t* lowest,
                    const std::int16_t* highest);
};

/// Plain C++: the reference.
[[nodiscard]] const MatchKernels& portable_kernels();
/// All that this processor can run, fastest first, the portable one last.
[[nodiscard]] const std::vector<const MatchKernels*>& usable_kernels();
[[nodiscard]] inline const MatchKernels& fastest_kernels() { return *usable_kernels().front(); }

/// The processor's own sets, or null where there are none or the processor lacks them.
[[nodiscard]] const MatchKernels* avx2_kernels();
[[nodiscard]] const MatchKernels* avx512_kernels();

}  // namespace cairn
