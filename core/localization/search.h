#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/localization/match_kernels.h"
#include "core/localization/match_raster.h"
#include "core/localization/turned_map.h"

namespace cairn {

/// How far around the prior pose is searched, in whole cells and equal turns (T4.3.3).
struct SearchWindow {
  double reach_m = 1.0;          ///< [m] In x and y, either way. [Limit: 0 … 20]
  double yaw_rad = 0.175;        ///< [rad] Either way. [Limit: 0 … π]
  double yaw_step_rad = 8.7e-3;  ///< [rad] [Limit: 1e-3 … π]
};

/// Two maps laid over each other where the prior has them, ready to be shifted and turned.
/// Shift (0, 0) is `reach` cells to the south-west of the prior.
struct MatchProblem {
  MatchRaster short_term;
  MatchRaster long_term;
  Turning turning;
  double prior_yaw_rad = 0.0;
  double yaw_step_rad = 0.0;
  int reach = 0;                  ///< [cells] Shifts either way.
  int yaw_reach = 0;              ///< Turns either way.
  std::uint32_t min_overlap = 1;  ///< Candidates with fewer cells known in both do not count.

  [[nodiscard]] int side() const { return 2 * reach + 1; }
  [[nodiscard]] int yaws() const { return 2 * yaw_reach + 1; }
  [[nodiscard]] double yaw_rad(int yaw) const {
    return prior_yaw_rad + (yaw - yaw_reach) * yaw_step_rad;
  }
  /// The long-term raster from a shift on.
  [[nodiscard]] std::size_t at(int x, int y) const { return long_term.index(x, y); }
};

/// One of the places tried.
struct Candidate {
  int yaw = 0;
  int y = 0;
  int x = 0;
  MatchSum sum;

  /// [mm] Mean truncated height difference. Requires: an overlap.
  [[nodiscard]] double score_mm() const {
    return static_cast<double>(sum.difference_mm) / static_cast<double>(sum.overlap);
  }
};

/// Whether `a` matches better than `b`, compared exactly.
[[nodiscard]] inline bool better(const MatchSum& a, const MatchSum& b) {
  return std::uint64_t{a.difference_mm} * b.overlap < std::uint64_t{b.difference_mm} * a.overlap;
}

/// The sums at every shift and turn, x fastest, then y, then yaw.
struct MatchVolume {
  int side = 0;
  int yaws = 0;
  std::uint32_t min_overlap = 1;
  std::vector<MatchSum> sums;

  [[nodiscard]] std::size_t index(int yaw, int y, int x) const {
    return (static_cast<std::size_t>(yaw) * static_cast<std::size_t>(side) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(side) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] const MatchSum& at(int yaw, int y, int x) const { return sums[index(yaw, y, x)]; }
  [[nodiscard]] Candidate candidate(std::size_t i) const;
  [[nodiscard]] bool counts(const MatchSum& sum) const { return sum.overlap >= min_overlap; }
};

/// Tries every shift and turn.
[[nodiscard]] MatchVolume search_all(const MatchProblem& problem, const MatchKernels& kernels);

/// The candidates that match better than all their neighbours, best first, at most `limit`; of
/// equal ones the first counts.
[[nodiscard]] std::vector<Candidate> basins(const MatchVolume& volume, std::size_t limit);

/// The thesis's answer in candidate coordinates (T4.3.3): scores inverted, normalised to 0 … 1,
/// raised to the fourth power; the mean, so weighted, of the good matches.
struct WeightedMean {
  double yaw = 0.0;
  double y = 0.0;
  double x = 0.0;
  std::size_t good = 0;  ///< How many matches took part; without any the mean means nothing.
};
/// `threshold` [0 … 1]: normalised scores from here on, before the power, are good matches.
[[nodiscard]] WeightedMean fourth_power_mean(const MatchVolume& volume, double threshold);

}  // namespace cairn
