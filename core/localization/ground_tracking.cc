#include "core/localization/ground_tracking.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace cairn {
namespace {

constexpr int kRounds = 6;
/// A hit that is further off than so many of its sigmas disagrees.
constexpr double kAgrees = 3.0;
/// Of the nine cells of a neighbourhood so many must be known.
constexpr int kKnownOfNine = 6;

/// Height of the map's ground below a place, if it is known and even there.
class Ground {
 public:
  Ground(const HeightMap& map, const GroundTrackingConfig& config) : map_(map), config_(config) {}

  [[nodiscard]] std::optional<double> height_m(double x_m, double y_m) const {
    const CellIndex middle = map_.cell_at(x_m, y_m);
    if (!map_.cell(middle).known()) return std::nullopt;
    // Least squares of a plane; the sums over a whole neighbourhood would be orthogonal.
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    std::vector<std::pair<Eigen::Vector3d, double>> cells;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell cell = map_.cell({middle.x + dx, middle.y + dy});
        if (!cell.known()) continue;
        const Eigen::Vector3d at(1.0, dx, dy);
        const double height_m = cell.height_mm / 1000.0;
        normal += at * at.transpose();
        right += at * height_m;
        cells.emplace_back(at, height_m);
      }
    }
    if (cells.size() < kKnownOfNine) return std::nullopt;
    const Eigen::Vector3d plane = normal.ldlt().solve(right);
    if (!plane.allFinite() || plane.tail<2>().norm() > config_.steepest * map_.cell_size_m()) {
      return std::nullopt;
    }
    for (const auto& [at, height_m] : cells) {
      if (std::abs(plane.dot(at) - height_m) > config_.plane_m) return std::nullopt;
    }
    return plane[0] + (plane[1] * (x_m - map_.centre_m(middle.x)) +
                       plane[2] * (y_m - map_.centre_m(middle.y))) /
                          map_.cell_size_m();
  }

 private:
  const HeightMap& map_;
  const GroundTrackingConfig& config_;
};

/// A hit on known ground: how far the map's ground lies above it, and how that depends on what is
/// wrong with (z, roll, pitch).
struct Hit {
  Eigen::Vector3d slope;
  double above_m = 0.0;
};

}  // namespace

void GroundTracking::move(double way_m, double tip_rad, double incline_sigma_rad) {
  // These errors last longer than a step: they add up as they are.
  z_sigma_m_ += std::abs(way_m) * incline_sigma_rad + config_.tip_lever_m * std::abs(tip_rad);
}

std::optional<Unevenness> GroundTracking::lay(const Scan& scan, const LaserSpec& laser,
                                              const Pose& T_site_robot, const HeightMap& map,
                                              double incline_sigma_rad) {
  const Ground ground(map, config_);
  const double cos_yaw = std::cos(T_site_robot.yaw_rad);
  const double sin_yaw = std::sin(T_site_robot.yaw_rad);
  const Eigen::Vector3d sigma(std::max(z_sigma_m_, config_.least_sigma_m), incline_sigma_rad,
                              incline_sigma_rad);
  std::vector<Hit> hits;
  for (const Beam& beam : beams_in_site(scan, laser, T_site_robot, 0.0)) {
    if (!beam.hit) continue;
    const double dx = beam.end_m.x() - T_site_robot.x_m;
    const double dy = beam.end_m.y() - T_site_robot.y_m;
    if (dx * dx + dy * dy > config_.reach_m * config_.reach_m) continue;
    const auto height_m = ground.height_m(beam.end_m.x(), beam.end_m.y());
    if (!height_m) continue;
    // Positive pitch lowers what is ahead, positive roll lifts what is to the left.
    const Hit hit{{1.0, -dx * sin_yaw + dy * cos_yaw, -(dx * cos_yaw + dy * sin_yaw)},
                  *height_m - beam.end_m.z()};
    const double expected_m = hit.slope.cwiseProduct(sigma).norm() + config_.hit_sigma_m;
    if (std::abs(hit.above_m) < kAgrees * expected_m) hits.push_back(hit);
  }
  if (hits.size() < static_cast<std::size_t>(config_.min_hits)) return std::nullopt;

  const Eigen::Matrix3d prior = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  const double share = std::min(1.0, config_.most_hits / static_cast<double>(hits.size()));
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = prior;
  for (int round = 0; round < kRounds; ++round) {
    information = prior;
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Hit& hit : hits) {
      // Geman and McClure's weight: what is far off counts for next to nothing.
      const double off = (hit.above_m - hit.slope.dot(error)) / (kAgrees * config_.hit_sigma_m);
      const double weight = share / ((1.0 + off * off) * (1.0 + off * off)) /
                            (config_.hit_sigma_m * config_.hit_sigma_m);
      information += weight * hit.slope * hit.slope.transpose();
      right += weight * hit.above_m * hit.slope;
    }
    error = information.ldlt().solve(right);
  }
  const auto agreeing = std::count_if(hits.begin(), hits.end(), [&](const Hit& hit) {
    return std::abs(hit.above_m - hit.slope.dot(error)) < kAgrees * config_.hit_sigma_m;
  });
  if (static_cast<double>(agreeing) < config_.min_share * static_cast<double>(hits.size())) {
    return std::nullopt;
  }
  const Eigen::Matrix3d covariance = information.inverse();
  z_sigma_m_ = std::max(std::sqrt(covariance(0, 0)), config_.least_sigma_m);
  return Unevenness{error[0], error[1], error[2],
                    std::sqrt(std::max(covariance(1, 1), covariance(2, 2)))};
}

}  // namespace cairn
