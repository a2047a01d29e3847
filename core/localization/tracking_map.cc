#include "core/localization/tracking_map.h"

#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

/// Surfaces whose normals differ by more are two, e.g. both sides of a thin wall.
constexpr double kSameSideCos = 0.7;
/// What was seen more often than this is no surer.
constexpr double kSureTimes = 5.0;

}  // namespace

std::uint64_t TrackingMap::square_of(const Eigen::Vector2d& p_m, int dx, int dy) const {
  const auto x = static_cast<std::int32_t>(std::floor(p_m.x() / config_.radius_m)) + dx;
  const auto y = static_cast<std::int32_t>(std::floor(p_m.y() / config_.radius_m)) + dy;
  return (std::uint64_t{static_cast<std::uint32_t>(y)} << 32U) | static_cast<std::uint32_t>(x);
}

void TrackingMap::add(const std::vector<SurfacePoint>& points, double way_m) {
  for (const SurfacePoint& point : points) {
    merge(point, way_m, squares_[square_of(point.p_m, 0, 0)]);
  }
}

void TrackingMap::merge(const SurfacePoint& point, double way_m, Square& square) {
  for (Seen& seen : square) {
    if ((seen.mean.p_m - point.p_m).squaredNorm() > config_.merge_m * config_.merge_m) continue;
    if (seen.mean.normal.dot(point.normal) < kSameSideCos) continue;
    seen.times = std::min(seen.times + 1.0, config_.most_seen);
    seen.mean.p_m += (point.p_m - seen.mean.p_m) / seen.times;
    seen.mean.normal =
        (seen.mean.normal + (point.normal - seen.mean.normal) / seen.times).normalized();
    seen.last_m = way_m;
    return;
  }
  if (points_ >= kMaxPoints) return;
  square.push_back({point, 1.0, way_m});
  ++points_;
}

void TrackingMap::forget_before(double way_m) {
  for (auto square = squares_.begin(); square != squares_.end();) {
    points_ -=
        std::erase_if(square->second, [way_m](const Seen& seen) { return seen.last_m < way_m; });
    square = square->second.empty() ? squares_.erase(square) : std::next(square);
  }
}

void TrackingMap::clear() {
  squares_.clear();
  points_ = 0;
}

std::optional<TrackingMap::Surface> TrackingMap::surface_at(const SurfacePoint& point) const {
  double weights = 0.0;
  double distance_m = 0.0;
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();
  const double radius_m2 = config_.radius_m * config_.radius_m;
  const double per_m2 = 1.0 / (config_.width_m * config_.width_m);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const auto square = squares_.find(square_of(point.p_m, dx, dy));
      if (square == squares_.end()) continue;
      for (const Seen& seen : square->second) {
        const Eigen::Vector2d d = point.p_m - seen.mean.p_m;
        const double d_m2 = d.squaredNorm();
        if (d_m2 > radius_m2 || seen.mean.normal.dot(point.normal) < kSameSideCos) continue;
        const double weight = std::exp(-d_m2 * per_m2) * std::min(seen.times, kSureTimes);
        weights += weight;
        distance_m += weight * d.dot(seen.mean.normal);
        normal += weight * seen.mean.normal;
      }
    }
  }
  if (weights <= 0.0) return std::nullopt;
  return Surface{distance_m / weights, normal.normalized()};
}

}  // namespace cairn
