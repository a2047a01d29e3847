#include "core/planner/tighten.h"

#include <cmath>

namespace cairn {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr int kMaxRounds = 12;
/// [part of the cost] A round that gains less is the last.
constexpr double kWorthARound = 1e-6;
/// [part of a corner's legs] How much of them is cut off, tried in this order.
constexpr double kCuts[] = {1.0, 0.5, 0.25, 0.1, 0.03};
/// [cost units] Less is no gain but noise of rounding.
constexpr double kGain = 1e-3;

/// Cost from the first point to each.
std::vector<double> costs_to(const LineCost& lines, const Points& points) {
  std::vector<double> costs(points.size());
  for (std::size_t i = 1; i < points.size(); ++i) {
    costs[i] = costs[i - 1] + lines.along(points[i - 1], points[i]);
  }
  return costs;
}

/// From each kept point straight to one as far along as pays, looking twice as far while it does.
Points shortcut(const LineCost& lines, const Points& points) {
  const std::vector<double> costs = costs_to(lines, points);
  const std::size_t last = points.size() - 1;
  const auto pays = [&](std::size_t from, std::size_t to) {
    if (to == from + 1) return true;
    const auto cost = lines.between(points[from], points[to]);
    return cost && *cost <= costs[to] - costs[from] + kGain;
  };
  Points kept{points.front()};
  for (std::size_t from = 0; from < last;) {
    std::size_t good = from + 1;
    std::size_t reach = 2;
    while (good < last && pays(from, std::min(from + reach, last))) {
      good = std::min(from + reach, last);
      reach *= 2;
    }
    std::size_t bad = std::min(from + reach, last + 1);
    while (good + 1 < bad) {
      const std::size_t middle = good + (bad - good) / 2;
      (pays(from, middle) ? good : bad) = middle;
    }
    kept.push_back(points[good]);
    from = good;
  }
  return kept;
}

/// The corner between `before` and `after` cut off as far as pays: nothing when it does not, else
/// the one or two points in its place (none when the corner can be left out).
std::optional<Points> cut(const LineCost& lines, const Eigen::Vector2d& before,
                          const Eigen::Vector2d& corner, const Eigen::Vector2d& after) {
  for (const double part : kCuts) {
    const Eigen::Vector2d first = corner + part * (before - corner);
    const Eigen::Vector2d second = corner + part * (after - corner);
    const auto across = lines.between(first, second);
    if (!across || *across > lines.along(first, corner) + lines.along(corner, second) - kGain) {
      continue;
    }
    return part == 1.0 ? Points{} : Points{first, second};
  }
  return {};
}

/// One round over all corners.
Points cut_corners(const LineCost& lines, const Points& points) {
  Points kept{points.front()};
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const auto instead = cut(lines, kept.back(), points[i], points[i + 1]);
    if (!instead) {
      kept.push_back(points[i]);
    } else {
      kept.insert(kept.end(), instead->begin(), instead->end());
    }
  }
  kept.push_back(points.back());
  return kept;
}

}  // namespace

double cost_along(const LineCost& lines, const Points& points_m) {
  return points_m.empty() ? 0.0 : costs_to(lines, points_m).back();
}

Points tighten(const LineCost& lines, Points points_m) {
  if (points_m.size() < 3) return points_m;
  double cost = cost_along(lines, points_m);
  for (int round = 0; round < kMaxRounds; ++round) {
    points_m = shortcut(lines, cut_corners(lines, shortcut(lines, points_m)));
    const double now = cost_along(lines, points_m);
    if (now > cost * (1 - kWorthARound)) break;
    cost = now;
  }
  return points_m;
}

}  // namespace cairn
