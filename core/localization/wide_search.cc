#include "core/localization/wide_search.h"

#include <algorithm>
#include <cstdlib>
#include <queue>
#include <vector>

namespace cairn {
namespace {

constexpr int kLevels = 3;  // Blocks of 8 × 8 shifts first.

/// The lowest and highest height that a cell meets at any shift of a block.
struct Level {
  std::vector<std::int16_t> lowest;
  std::vector<std::int16_t> highest;
};

/// Shifts [x, x + 2^level) × [y, y + 2^level) of one turn, and the least any of them can score.
struct Node {
  double bound_mm;
  int level;
  Candidate first;

  /// The queue gives the least bound; of equals the deepest, which ends soonest.
  friend bool operator<(const Node& a, const Node& b) {
    if (a.bound_mm != b.bound_mm) return a.bound_mm > b.bound_mm;
    return a.level > b.level;
  }
};

bool is_unknown(std::int16_t lowest) { return lowest == kUnknownInLong; }

/// Both: whatever lies in between bounds nothing, but may overlap.
void join(std::int16_t& lowest, std::int16_t& highest, std::int16_t other_lowest,
          std::int16_t other_highest) {
  if (is_unknown(lowest) && is_unknown(other_lowest)) return;
  if (is_unknown(lowest) || is_unknown(other_lowest)) {
    lowest = -kMatchLimitMm;
    highest = kMatchLimitMm;
    return;
  }
  lowest = std::min(lowest, other_lowest);
  highest = std::max(highest, other_highest);
}

/// Doubles the blocks of a level. Beyond the raster nothing is known.
Level doubled(const Level& level, const MatchRaster& raster, int step) {
  Level next = level;
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      const std::size_t i = raster.index(x, y);
      for (const auto& [dx, dy] : {std::pair{step, 0}, {0, step}, {step, step}}) {
        const bool inside = x + dx < raster.width && y + dy < raster.height;
        const std::size_t k = inside ? raster.index(x + dx, y + dy) : 0;
        join(next.lowest[i], next.highest[i], inside ? level.lowest[k] : kUnknownInLong,
             inside ? level.highest[k] : kUnknownInLong);
      }
    }
  }
  return next;
}

class BranchAndBound {
 public:
  BranchAndBound(const MatchProblem& problem, const MatchKernels& kernels, double limit_mm,
                 const std::optional<Excluded>& excluded)
      : problem_(problem), kernels_(kernels), limit_mm_(limit_mm), excluded_(excluded) {
    levels_.push_back({problem.long_term.height_mm, problem.long_term.height_mm});
    for (int level = 0; level < kLevels; ++level) {
      levels_.push_back(doubled(levels_.back(), problem.long_term, 1 << level));
    }
    for (int yaw = 0; yaw < problem.yaws(); ++yaw) {
      turned_.push_back(turn(problem.short_term, problem.turning, problem.yaw_rad(yaw)));
    }
  }

  WideMatch run() {
    constexpr int kBlock = 1 << kLevels;
    for (int yaw = 0; yaw < problem_.yaws(); ++yaw) {
      for (int y = 0; y < problem_.side(); y += kBlock) {
        for (int x = 0; x < problem_.side(); x += kBlock) consider(kLevels, {yaw, y, x, {}});
      }
    }
    while (!open_.empty()) {
      const Node node = open_.top();
      open_.pop();
      if (node.bound_mm > limit_mm_) break;
      divide(node);
    }
    return found_;
  }

 private:
  void divide(const Node& node) {
    const int half = 1 << (node.level - 1);
    for (const int y : {node.first.y, node.first.y + half}) {
      for (const int x : {node.first.x, node.first.x + half}) {
        if (y >= problem_.side() || x >= problem_.side()) continue;
        consider(node.level - 1, {node.first.yaw, y, x, {}});
      }
    }
  }

  void consider(int level, Candidate first) {
    const Level& heights = levels_[static_cast<std::size_t>(level)];
    const std::size_t at = problem_.at(first.x, first.y);
    first.sum = kernels_.bound(turned_[static_cast<std::size_t>(first.yaw)],
                               heights.lowest.data() + at, heights.highest.data() + at);
    ++found_.bounds;
    if (first.sum.overlap < problem_.min_overlap) return;
    const double bound_mm = first.score_mm();
    if (level > 0) {
      if (bound_mm <= limit_mm_) open_.push({bound_mm, level, first});
    } else if (!excluded_ || !excluded_->holds(first.yaw, first.y, first.x)) {
      take(first, bound_mm);
    }
  }

  void take(const Candidate& candidate, double score_mm) {
    const bool wins = found_.best ? better(candidate.sum, found_.best->sum) ||
                                        (!better(found_.best->sum, candidate.sum) &&
                                         before(candidate, *found_.best))
                                  : score_mm < limit_mm_;
    if (!wins) return;
    found_.best = candidate;
    limit_mm_ = score_mm;
  }

  static bool before(const Candidate& a, const Candidate& b) {
    if (a.yaw != b.yaw) return a.yaw < b.yaw;
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  }

  const MatchProblem& problem_;
  const MatchKernels& kernels_;
  double limit_mm_;
  const std::optional<Excluded>& excluded_;
  std::vector<Level> levels_;
  std::vector<TurnedMap> turned_;
  std::priority_queue<Node> open_;
  WideMatch found_;
};

}  // namespace

bool Excluded::holds(int yaw, int y, int x) const {
  return std::abs(yaw - centre.yaw) <= turns && std::abs(y - centre.y) <= cells &&
         std::abs(x - centre.x) <= cells;
}

WideMatch search_wide(const MatchProblem& problem, const MatchKernels& kernels, double limit_mm,
                      const std::optional<Excluded>& excluded) {
  return BranchAndBound(problem, kernels, limit_mm, excluded).run();
}

}  // namespace cairn
