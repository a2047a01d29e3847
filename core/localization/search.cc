#include "core/localization/search.h"

#include <algorithm>
#include <limits>

namespace cairn {
namespace {

/// Whether candidate `i` matches better than its neighbour, ties going to the earlier one.
bool beats(const MatchVolume& volume, std::size_t i, std::size_t neighbour) {
  const MatchSum& a = volume.sums[i];
  const MatchSum& b = volume.sums[neighbour];
  if (!volume.counts(b)) return true;
  return better(a, b) || (!better(b, a) && i < neighbour);
}

bool is_minimum(const MatchVolume& volume, const Candidate& c, std::size_t i) {
  const auto inside = [](int at, int count) { return at >= 0 && at < count; };
  for (int yaw = c.yaw - 1; yaw <= c.yaw + 1; ++yaw) {
    for (int y = c.y - 1; y <= c.y + 1; ++y) {
      for (int x = c.x - 1; x <= c.x + 1; ++x) {
        if (!inside(yaw, volume.yaws) || !inside(y, volume.side) || !inside(x, volume.side)) {
          continue;
        }
        const std::size_t neighbour = volume.index(yaw, y, x);
        if (neighbour != i && !beats(volume, i, neighbour)) return false;
      }
    }
  }
  return true;
}

struct Range {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
};

Range scores_of(const MatchVolume& volume) {
  Range range;
  for (std::size_t i = 0; i < volume.sums.size(); ++i) {
    if (!volume.counts(volume.sums[i])) continue;
    const double score_mm = volume.candidate(i).score_mm();
    range = {std::min(range.lowest, score_mm), std::max(range.highest, score_mm)};
  }
  return range;
}

}  // namespace

Candidate MatchVolume::candidate(std::size_t i) const {
  const auto s = static_cast<std::size_t>(side);
  return {static_cast<int>(i / (s * s)), static_cast<int>(i / s % s), static_cast<int>(i % s),
          sums[i]};
}

MatchVolume search_all(const MatchProblem& problem, const MatchKernels& kernels) {
  const auto side = static_cast<std::size_t>(problem.side());
  MatchVolume volume{problem.side(), problem.yaws(), problem.min_overlap, {}};
  volume.sums.resize(side * side * static_cast<std::size_t>(problem.yaws()));
  for (int yaw = 0; yaw < problem.yaws(); ++yaw) {
    const TurnedMap turned = turn(problem.short_term, problem.turning, problem.yaw_rad(yaw));
    kernels.square(turned, problem.long_term.height_mm.data(), problem.long_term.width,
                   problem.side(), &volume.sums[volume.index(yaw, 0, 0)]);
  }
  return volume;
}

std::vector<Candidate> basins(const MatchVolume& volume, std::size_t limit) {
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < volume.sums.size(); ++i) {
    if (!volume.counts(volume.sums[i])) continue;
    const Candidate candidate = volume.candidate(i);
    if (is_minimum(volume, candidate, i)) found.push_back(candidate);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return better(a.sum, b.sum); });
  if (found.size() > limit) found.resize(limit);
  return found;
}

WeightedMean fourth_power_mean(const MatchVolume& volume, double threshold) {
  const Range scores = scores_of(volume);
  const double spread = scores.highest - scores.lowest;
  WeightedMean mean;
  double total = 0.0;
  for (std::size_t i = 0; i < volume.sums.size(); ++i) {
    if (!volume.counts(volume.sums[i])) continue;
    const Candidate c = volume.candidate(i);
    const double inverted = spread > 0.0 ? (scores.highest - c.score_mm()) / spread : 1.0;
    if (inverted < threshold) continue;
    const double weight = inverted * inverted * inverted * inverted;
    mean.yaw += weight * c.yaw;
    mean.y += weight * c.y;
    mean.x += weight * c.x;
    total += weight;
    ++mean.good;
  }
  if (total > 0.0) {
    mean.yaw /= total;
    mean.y /= total;
    mean.x /= total;
  }
  return mean;
}

}  // namespace cairn
