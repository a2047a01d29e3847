#include "robot_agent/drive/escape.h"

#include <numbers>

#include "core/common/angle.h"

namespace cairn::agent {
namespace {

/// [m] The track's last points lie this near: the way out leads over them, not to them.
constexpr double kArrivedM = 0.1;

std::vector<Eigen::Vector2d> shortened(const std::vector<Eigen::Vector2d>& way_m, double most_m) {
  std::vector<Eigen::Vector2d> part_m{way_m.front()};
  double length_m = 0.0;
  for (std::size_t i = 1; i < way_m.size() && length_m < most_m; ++i) {
    length_m += (way_m[i] - way_m[i - 1]).norm();
    part_m.push_back(way_m[i]);
  }
  return part_m;
}

}  // namespace

Escape::Escape(const FollowerConfig& config, const Track& track, const Eigen::Vector2d& place_m,
               double speed_m_s)
    : follower_(config, shortened(track.back_from(place_m), kMostM)), speed_m_s_(speed_m_s) {}

std::optional<DriveCommand> Escape::step(const Pose& pose) {
  follower_.advance({pose.x_m, pose.y_m});
  if (follower_.to_go_m() < kArrivedM) return std::nullopt;
  // What follows a path forwards follows it backwards when its back is taken for its front.
  Pose turned = pose;
  turned.yaw_rad = wrap_angle(pose.yaw_rad + std::numbers::pi);
  DriveCommand command = follower_.steer(turned, speed_m_s_);
  command.speed_m_s = -command.speed_m_s;
  return command;
}

}  // namespace cairn::agent
