#include "robot_agent/drive/path_follower.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/common/angle.h"

namespace cairn::agent {

namespace {

/// [m] How far along the path the foot is searched: a path that comes near itself is not cut short.
constexpr double kSearchM = 1.5;
/// [m] A later place on the path must be this much nearer, so that rounding cuts no turn short.
constexpr double kTieM = 1e-3;

Eigen::Vector2d nearest_on_leg(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                               const Eigen::Vector2d& p) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  if (length2 <= 0.0) return a;
  return a + std::clamp((p - a).dot(along) / length2, 0.0, 1.0) * along;
}

}  // namespace

double turn_on_the_spot_rad_s(const FollowerConfig& config, double left_rad) {
  const double rate = std::max(1.5 * std::abs(left_rad), config.creep_rad_s);
  return std::copysign(std::min(rate, config.max_turn_rad_s), left_rad);
}

PathFollower::PathFollower(const FollowerConfig& config, std::vector<Eigen::Vector2d> path_m)
    : config_(config), path_m_(std::move(path_m)) {
  assert(!path_m_.empty());
  foot_m_ = place_m_ = path_m_.front();
}

void PathFollower::advance(const Eigen::Vector2d& place_m) {
  place_m_ = place_m;
  double best_m = std::numeric_limits<double>::infinity();
  Eigen::Vector2d from = foot_m_;
  Eigen::Vector2d foot = foot_m_;
  std::size_t leg = leg_;
  double searched_m = 0.0;
  for (std::size_t i = leg_; i + 1 < path_m_.size() && searched_m < kSearchM; ++i) {
    const Eigen::Vector2d candidate = nearest_on_leg(from, path_m_[i + 1], place_m);
    if (const double distance_m = (candidate - place_m).norm(); distance_m < best_m - kTieM) {
      best_m = distance_m;
      foot = candidate;
      leg = i;
    }
    searched_m += (path_m_[i + 1] - from).norm();
    from = path_m_[i + 1];
  }
  foot_m_ = foot;
  leg_ = leg;
}

std::vector<Eigen::Vector2d> PathFollower::ahead() const {
  std::vector<Eigen::Vector2d> rest{foot_m_};
  for (std::size_t i = leg_ + 1; i < path_m_.size(); ++i) rest.push_back(path_m_[i]);
  return rest;
}

double PathFollower::to_go_m() const {
  double way_m = 0.0;
  Eigen::Vector2d from = foot_m_;
  for (std::size_t i = leg_ + 1; i < path_m_.size(); ++i) {
    way_m += (path_m_[i] - from).norm();
    from = path_m_[i];
  }
  return way_m + off_path_m();
}

double PathFollower::off_path_m() const { return (place_m_ - foot_m_).norm(); }

Eigen::Vector2d PathFollower::target(double lookahead_m) const {
  double left_m = lookahead_m;
  Eigen::Vector2d from = foot_m_;
  for (std::size_t i = leg_ + 1; i < path_m_.size(); ++i) {
    const double leg_m = (path_m_[i] - from).norm();
    if (leg_m >= left_m) return from + (path_m_[i] - from) * (left_m / leg_m);
    left_m -= leg_m;
    from = path_m_[i];
  }
  return path_m_.back();
}

DriveCommand PathFollower::steer(const Pose& pose, double limit_m_s) const {
  return steer_to(target(config_.lookahead_m), config_.turn_in_place_rad, pose, limit_m_s);
}

DriveCommand PathFollower::steer_closely(const Pose& pose, double limit_m_s) const {
  return steer_to(target(config_.close_lookahead_m), config_.close_turn_rad, pose,
                  std::min(limit_m_s, config_.close_speed_m_s));
}

DriveCommand PathFollower::steer_to(const Eigen::Vector2d& target_m, double turn_in_place_rad,
                                    const Pose& pose, double limit_m_s) const {
  const Eigen::Vector2d to_target = target_m - Eigen::Vector2d(pose.x_m, pose.y_m);
  const double distance_m = to_target.norm();
  const double error_rad = wrap_angle(std::atan2(to_target.y(), to_target.x()) - pose.yaw_rad);
  if (std::abs(error_rad) > turn_in_place_rad) {
    return {0.0, turn_on_the_spot_rad_s(config_, error_rad)};
  }
  const double brake_m_s = std::sqrt(2.0 * config_.deceleration_m_s2 * to_go_m());
  double speed =
      std::min({config_.max_speed_m_s, limit_m_s, std::max(brake_m_s * 0.8, config_.creep_m_s)});
  const double curvature = 2.0 * std::sin(error_rad) / std::max(distance_m, 0.05);
  if (std::abs(curvature) * speed > config_.max_turn_rad_s) {
    speed = config_.max_turn_rad_s / std::abs(curvature);
  }
  return {speed, curvature * speed};
}

}  // namespace cairn::agent
