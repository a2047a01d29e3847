#include "core/localization/tracking.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "core/common/angle.h"

namespace cairn {
namespace {

/// [m] Of way between two rounds of forgetting.
constexpr double kForgetEveryM = 1.0;
/// [rad] Headings from where a sweep that does not match is tried again.
constexpr std::array kOtherHeadings{0.1, -0.1, 0.2, -0.2, 0.35, -0.35};

SurfacePoint placed(const SurfacePoint& point, const Eigen::Vector3d& place) {
  const double c = std::cos(place[2]);
  const double s = std::sin(place[2]);
  const auto turn = [c, s](const Eigen::Vector2d& v) {
    return Eigen::Vector2d(c * v.x() - s * v.y(), s * v.x() + c * v.y());
  };
  return {turn(point.p_m) + place.head<2>(), turn(point.normal)};
}

Eigen::Vector3d difference(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Vector3d d = a - b;
  d[2] = wrap_angle(d[2]);
  return d;
}

}  // namespace

/// A place and how well the sweep lies there.
struct Tracking::Fit {
  Eigen::Vector3d place;                                  ///< x, y [m], yaw [rad].
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< Of the match alone.
  std::size_t near_points = 0;
  double agreement = 0.0;
};

TrackedStep Tracking::track(const Scan& scan, const LaserSpec& laser, const Pose& predicted,
                            const Eigen::Matrix3d& covariance) {
  TrackedStep step{.T_local_robot = predicted};
  if (!is_finite(predicted) || !covariance.allFinite()) return step;
  const std::vector<SurfacePoint> points = surface_points(scan, laser, predicted, config_.points);
  const Eigen::Vector3d start(predicted.x_m, predicted.y_m, predicted.yaw_rad);
  Eigen::Matrix3d floored = covariance;
  floored.diagonal() +=
      Eigen::Vector3d(config_.step_floor_m, config_.step_floor_m, config_.step_floor_rad)
          .cwiseAbs2();
  const Eigen::Matrix3d information = floored.inverse();
  const Fit found = best_fit(points, start, information);
  step.agreement = found.agreement;
  step.near_points = found.near_points;
  step.matched = good(found);
  if (step.matched && !believed(difference(found.place, start), information)) {
    step.matched = false;
    step.surprising = true;
    return step;
  }
  if (step.matched) {
    step.T_local_robot.x_m = found.place[0];
    step.T_local_robot.y_m = found.place[1];
    step.T_local_robot.yaw_rad = wrap_angle(found.place[2]);
    step.information = found.information;
  }
  misses_ = step.matched || found.near_points < config_.min_points ? 0 : misses_ + 1;
  step.kept = keep(points, step.matched ? found.place : start);
  return step;
}

bool Tracking::good(const Fit& fit) const {
  return fit.near_points >= config_.min_points && fit.agreement >= config_.min_agreement;
}

bool Tracking::believed(const Eigen::Vector3d& off, const Eigen::Matrix3d& information) {
  const auto sigmas2 = [&](const Eigen::Vector3d& d) { return d.dot(information * d); };
  const double most2 = config_.surprise * config_.surprise;
  if (sigmas2(off) <= most2) {
    surprise_.reset();
    return true;
  }
  const bool confirmed = surprise_ && sigmas2(difference(off, *surprise_)) <= most2;
  surprise_ = off;
  if (confirmed) surprise_.reset();
  return confirmed;
}

Tracking::Fit Tracking::best_fit(const std::vector<SurfacePoint>& points,
                                 const Eigen::Vector3d& predicted,
                                 const Eigen::Matrix3d& information) const {
  Fit best = fit(points, predicted, information, predicted);
  if (good(best) || best.near_points < config_.min_points) return best;
  for (const double turn_rad : kOtherHeadings) {
    Eigen::Vector3d start = predicted;
    start[2] += turn_rad;
    const Fit other = fit(points, predicted, information, start);
    if (other.agreement > best.agreement) best = other;
  }
  return best;
}

Tracking::Fit Tracking::fit(const std::vector<SurfacePoint>& points,
                            const Eigen::Vector3d& predicted, const Eigen::Matrix3d& information,
                            const Eigen::Vector3d& start) const {
  Fit fit{.place = start};
  const double opinion =
      1.0 / (config_.points_per_opinion * config_.surface_sigma_m * config_.surface_sigma_m);
  double scale_m = config_.begin_scale_m;
  for (int i = 0; i < config_.iterations; ++i) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = information * difference(fit.place, predicted);
    for (const SurfacePoint& point : points) {
      const SurfacePoint at = placed(point, fit.place);
      const auto surface = map_.surface_at(at);
      if (!surface) continue;
      const Eigen::Vector2d arm = at.p_m - fit.place.head<2>();
      const Eigen::Vector2d& n = surface->normal;
      const Eigen::Vector3d J(n.x(), n.y(), n.y() * arm.x() - n.x() * arm.y());
      // Geman-McClure: what lies far off belongs to something else.
      const double off2 = surface->distance_m * surface->distance_m;
      const double robust = scale_m * scale_m / (scale_m * scale_m + off2);
      const double weight = opinion * robust * robust;
      H += weight * J * J.transpose();
      g += weight * surface->distance_m * J;
    }
    const Eigen::Vector3d step = (H + information).ldlt().solve(-g);
    fit.place += step;
    fit.information = H;
    if (scale_m <= config_.agree_m && step.head<2>().norm() < 1e-4 && std::abs(step[2]) < 1e-5) {
      break;
    }
    scale_m = std::max(0.6 * scale_m, config_.agree_m);
  }
  judge(fit, points);
  return fit;
}

void Tracking::judge(Fit& fit, const std::vector<SurfacePoint>& points) const {
  std::size_t agree = 0;
  for (const SurfacePoint& point : points) {
    const auto surface = map_.surface_at(placed(point, fit.place));
    if (!surface) continue;
    ++fit.near_points;
    if (std::abs(surface->distance_m) < config_.agree_m) ++agree;
  }
  if (fit.near_points > 0) {
    fit.agreement = static_cast<double>(agree) / static_cast<double>(fit.near_points);
  }
}

bool Tracking::keep(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& place) {
  way_m_ += (place - last_place_).head<2>().norm();
  last_place_ = place;
  const Eigen::Vector3d moved = difference(place, last_kept_);
  if (!map_.empty() && moved.head<2>().norm() < config_.keep_every_m &&
      std::abs(moved[2]) < config_.keep_every_rad) {
    return false;
  }
  std::vector<SurfacePoint> seen;
  seen.reserve(points.size());
  for (const SurfacePoint& point : points) seen.push_back(placed(point, place));
  map_.add(seen, way_m_);
  last_kept_ = place;
  if (way_m_ - forgotten_m_ >= kForgetEveryM) {
    map_.forget_before(way_m_ - config_.remember_m);
    forgotten_m_ = way_m_;
  }
  return true;
}

}  // namespace cairn
