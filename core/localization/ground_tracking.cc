#include "core/localization/ground_tracking.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace cairn {
namespace {

constexpr int kRounds = 6;
/// A hit that is further off than so many of its sigmas disagrees.
constexpr double kAgrees = 3.0;
/// Of the nine cells of a neighbourhood so many must be known.
constexpr int kKnownOfNine = 6;

/// The map's ground, where it is known and even.
class Ground {
 public:
  Ground(const HeightMap& map, const GroundTrackingConfig& config) : map_(map), config_(config) {}

  [[nodiscard]] std::optional<double> height_m(double x_m, double y_m) const {
    const CellIndex middle = map_.cell_at(x_m, y_m);
    if (!map_.cell(middle).known()) return std::nullopt;
    const std::vector<Corner> corners = around(middle);
    if (corners.size() < kKnownOfNine) return std::nullopt;
    const Eigen::Vector3d plane = plane_through(corners);
    if (!even(plane, corners)) return std::nullopt;
    return plane.dot(Eigen::Vector3d(1.0, x_m / map_.cell_size_m() - (middle.x + 0.5),
                                     y_m / map_.cell_size_m() - (middle.y + 0.5)));
  }

 private:
  /// A known cell: (1, x, y) [cells] from the middle one, and its height.
  struct Corner {
    Eigen::Vector3d at;
    double height_m = 0.0;
  };

  [[nodiscard]] std::vector<Corner> around(CellIndex middle) const {
    std::vector<Corner> corners;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell cell = map_.cell({middle.x + dx, middle.y + dy});
        if (cell.known())
          corners.push_back({{1.0, double(dx), double(dy)}, cell.height_mm / 1000.0});
      }
    }
    return corners;
  }

  [[nodiscard]] static Eigen::Vector3d plane_through(const std::vector<Corner>& corners) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Corner& corner : corners) {
      normal += corner.at * corner.at.transpose();
      right += corner.at * corner.height_m;
    }
    return normal.ldlt().solve(right);
  }

  [[nodiscard]] bool even(const Eigen::Vector3d& plane, const std::vector<Corner>& corners) const {
    if (!plane.allFinite()) return false;
    if (plane.tail<2>().norm() > config_.steepest * map_.cell_size_m()) return false;
    return std::all_of(corners.begin(), corners.end(), [&](const Corner& corner) {
      return std::abs(plane.dot(corner.at) - corner.height_m) <= config_.plane_m;
    });
  }

  const HeightMap& map_;
  const GroundTrackingConfig& config_;
};

/// A hit on known ground: how far the map's ground lies above it, and how that depends on what is
/// wrong with (z, roll, pitch).
struct Hit {
  Eigen::Vector3d slope;
  double above_m = 0.0;
};

struct Hits {
  std::vector<Hit> on_ground;
  std::size_t all = 0;  ///< Above or below known ground.
};

/// `sigma`: what may be wrong with (z, roll, pitch). What is off by more than that is no ground.
Hits hits_near_ground(const std::vector<Beam>& beams, const Pose& T_site_robot,
                      const Ground& ground, const Eigen::Vector3d& sigma,
                      const GroundTrackingConfig& config) {
  const double cos_yaw = std::cos(T_site_robot.yaw_rad);
  const double sin_yaw = std::sin(T_site_robot.yaw_rad);
  Hits hits;
  for (const Beam& beam : beams) {
    const double dx = beam.end_m.x() - T_site_robot.x_m;
    const double dy = beam.end_m.y() - T_site_robot.y_m;
    if (!beam.hit || dx * dx + dy * dy > config.reach_m * config.reach_m) continue;
    const auto height_m = ground.height_m(beam.end_m.x(), beam.end_m.y());
    if (!height_m) continue;
    ++hits.all;
    // Positive pitch lowers what is ahead, positive roll lifts what is to the left.
    const Hit hit{{1.0, -dx * sin_yaw + dy * cos_yaw, -(dx * cos_yaw + dy * sin_yaw)},
                  *height_m - beam.end_m.z()};
    const double expected_m = hit.slope.cwiseProduct(sigma).norm() + config.hit_sigma_m;
    if (std::abs(hit.above_m) < kAgrees * expected_m) hits.on_ground.push_back(hit);
  }
  return hits;
}

struct Fit {
  Eigen::Vector3d error;  ///< Of (z, roll, pitch).
  Eigen::Matrix3d covariance;
};

/// Robust least squares with a prior, weights after Geman and McClure (1987): what is far off
/// counts for next to nothing.
Fit fit(const std::vector<Hit>& hits, const Eigen::Vector3d& sigma,
        const GroundTrackingConfig& config) {
  const Eigen::Matrix3d prior = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  const double share = std::min(1.0, config.most_hits / static_cast<double>(hits.size()));
  const double most_weight = share / (config.hit_sigma_m * config.hit_sigma_m);
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = prior;
  for (int round = 0; round < kRounds; ++round) {
    information = prior;
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Hit& hit : hits) {
      const double off = (hit.above_m - hit.slope.dot(error)) / (kAgrees * config.hit_sigma_m);
      const double weight = most_weight / ((1.0 + off * off) * (1.0 + off * off));
      information += weight * hit.slope * hit.slope.transpose();
      right += weight * hit.above_m * hit.slope;
    }
    error = information.ldlt().solve(right);
  }
  return {error, information.inverse()};
}

double agreeing(const std::vector<Hit>& hits, const Eigen::Vector3d& error, double within_m) {
  return static_cast<double>(std::count_if(hits.begin(), hits.end(), [&](const Hit& hit) {
    return std::abs(hit.above_m - hit.slope.dot(error)) < within_m;
  }));
}

}  // namespace

void GroundTracking::move(double way_m, double tip_rad, double incline_sigma_rad) {
  // These errors last longer than a step: they add up as they are.
  restart(z_sigma_m_ + std::abs(way_m) * incline_sigma_rad +
          config_.tip_lever_m * std::abs(tip_rad));
}

void GroundTracking::restart(double sigma_m) {
  z_sigma_m_ = std::clamp(sigma_m, config_.least_sigma_m, config_.most_sigma_m);
}

std::optional<Unevenness> GroundTracking::lay(const Scan& scan, const LaserSpec& laser,
                                              const Pose& T_site_robot, const HeightMap& map,
                                              double incline_sigma_rad) {
  const Eigen::Vector3d sigma(z_sigma_m_, incline_sigma_rad, incline_sigma_rad);
  const auto [hits, all] = hits_near_ground(beams_in_site(scan, laser, T_site_robot, 0.0),
                                            T_site_robot, Ground(map, config_), sigma, config_);
  const auto least = static_cast<std::size_t>(config_.min_hits);
  if (all >= 2 * least) {
    in_doubt_ = static_cast<double>(hits.size()) < config_.doubt_share * static_cast<double>(all);
  }
  if (hits.size() < least) return std::nullopt;
  const auto [error, covariance] = fit(hits, sigma, config_);
  if (agreeing(hits, error, kAgrees * config_.hit_sigma_m) <
      config_.min_share * static_cast<double>(hits.size())) {
    return std::nullopt;
  }
  if (!confirmed(error[0])) {
    in_doubt_ = true;
    return std::nullopt;
  }
  restart(std::sqrt(covariance(0, 0)));
  return Unevenness{error[0], error[1], error[2],
                    std::sqrt(std::max(covariance(1, 1), covariance(2, 2)))};
}

bool GroundTracking::confirmed(double step_m) {
  const auto asked_m = std::exchange(sudden_step_m_, std::nullopt);
  if (std::abs(step_m) <= config_.sudden_m) return true;
  if (asked_m && std::abs(*asked_m - step_m) < kAgrees * config_.hit_sigma_m) return true;
  sudden_step_m_ = step_m;
  return false;
}

}  // namespace cairn
