#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/pose/pose.h"
#include "robot_agent/drive/path_follower.h"
#include "robot_agent/drive/track.h"

namespace cairn::agent {

/// Backs a robot that is closed in out along the way it came: where it has driven there is ground.
class Escape {
 public:
  /// [m] No further than this: from there it can look again.
  static constexpr double kMostM = 2.5;

  Escape(const FollowerConfig& config, const Track& track, const Eigen::Vector2d& place_m,
         double speed_m_s);

  /// Backwards along the track. nullopt when its end is reached.
  std::optional<DriveCommand> step(const Pose& pose);

 private:
  PathFollower follower_;
  double speed_m_s_;
};

}  // namespace cairn::agent
