#include "core/localization/tracking_points.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace cairn {
namespace {

struct Hit {
  Eigen::Vector2d p_m;
  double range_m = 0.0;
  int beam = 0;
};

std::vector<Hit> hits_of(const Scan& scan, const LaserSpec& laser, const Eigen::Isometry3d& T,
                         double range_m) {
  std::vector<Hit> hits;
  const std::size_t count =
      std::min(scan.range_m.size(), static_cast<std::size_t>(std::max(laser.beam_count, 0)));
  for (std::size_t i = 0; i < count; ++i) {
    const auto r_m = static_cast<double>(scan.range_m[i]);
    if (!(r_m >= laser.min_range_m) || r_m >= std::min(laser.max_range_m, range_m)) continue;
    const double angle = laser.first_angle_rad + static_cast<double>(i) * laser.step_rad;
    const Eigen::Vector3d p = T * Eigen::Vector3d(r_m * std::cos(angle), r_m * std::sin(angle), 0);
    hits.push_back({p.head<2>(), r_m, static_cast<int>(i)});
  }
  return hits;
}

/// Neighbours in the sweep that may lie on one surface: no beam between them missed, and the step
/// between them is what a surface seen at an angle of `slant` makes at most.
bool connected(const Hit& a, const Hit& b, const LaserSpec& laser,
               const SurfacePointsConfig& config) {
  const double between_rad = std::abs((b.beam - a.beam) * laser.step_rad);
  const double reach_m =
      0.03 + std::min(a.range_m, b.range_m) * between_rad / std::sin(config.slant_rad);
  return std::abs(b.beam - a.beam) <= 2 && (b.p_m - a.p_m).norm() <= reach_m;
}

/// The stretch of hits around one that lies on one surface: [first, last].
struct Stretch {
  std::size_t first;
  std::size_t last;
};

Stretch stretch_around(const std::vector<Hit>& hits, std::size_t at, const LaserSpec& laser,
                       const SurfacePointsConfig& config) {
  Stretch stretch{at, at};
  const auto enough = [&](std::size_t there) {
    const std::size_t away = there > at ? there - at : at - there;
    return away > static_cast<std::size_t>(config.least_neighbours) &&
           (hits[there].p_m - hits[at].p_m).norm() > config.surface_m;
  };
  while (stretch.last + 1 < hits.size() && !enough(stretch.last + 1) &&
         connected(hits[stretch.last], hits[stretch.last + 1], laser, config)) {
    ++stretch.last;
  }
  while (stretch.first > 0 && !enough(stretch.first - 1) &&
         connected(hits[stretch.first - 1], hits[stretch.first], laser, config)) {
    --stretch.first;
  }
  return stretch;
}

/// Normal of the line through the stretch; nothing when there is no line.
std::optional<Eigen::Vector2d> normal_of(const std::vector<Hit>& hits, const Stretch& stretch,
                                         const SurfacePointsConfig& config) {
  const auto count = static_cast<double>(stretch.last - stretch.first + 1);
  if (count < config.least_neighbours + 1) return std::nullopt;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (std::size_t i = stretch.first; i <= stretch.last; ++i) mean += hits[i].p_m / count;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
    const Eigen::Vector2d d = hits[i].p_m - mean;
    spread += d * d.transpose() / count;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(spread);
  const double off_m = std::sqrt(std::max(axes.eigenvalues()[0], 0.0));
  const double along_m = std::sqrt(axes.eigenvalues()[1]);
  if (!(off_m <= std::max(config.roughness * along_m, 0.01))) return std::nullopt;
  return Eigen::Vector2d(axes.eigenvectors().col(0));
}

}  // namespace

std::vector<SurfacePoint> surface_points(const Scan& scan, const LaserSpec& laser,
                                         const Pose& attitude, const SurfacePointsConfig& config) {
  const Pose tilt{.roll_rad = attitude.roll_rad, .pitch_rad = attitude.pitch_rad};
  const Eigen::Isometry3d T = to_transform(tilt) * to_transform(laser.T_robot_sensor);
  const Eigen::Vector2d eye = T.translation().head<2>();
  const std::vector<Hit> hits = hits_of(scan, laser, T, config.range_m);
  std::vector<SurfacePoint> points;
  std::optional<Eigen::Vector2d> last;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Eigen::Vector2d& p = hits[i].p_m;
    if (last && (p - *last).norm() < config.spacing_m) continue;
    auto normal = normal_of(hits, stretch_around(hits, i, laser, config), config);
    if (!normal) continue;
    const Eigen::Vector2d to_eye = (eye - p).normalized();
    if (normal->dot(to_eye) < 0.0) *normal = -*normal;
    if (normal->dot(to_eye) < std::sin(config.slant_rad)) continue;
    points.push_back({p, *normal});
    last = p;
  }
  return points;
}

}  // namespace cairn
