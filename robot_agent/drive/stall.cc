#include "robot_agent/drive/stall.h"

#include <cmath>

#include "core/common/angle.h"

namespace cairn::agent {

bool Stall::step(const Pose& pose, const DriveCommand& command, MonotonicTime clock) {
  const bool told = std::abs(command.speed_m_s) >= kLeastSpeedMS ||
                    std::abs(command.turn_rate_rad_s) >= kLeastTurnRadS;
  const bool moved = std::hypot(pose.x_m - from_.x_m, pose.y_m - from_.y_m) >= kMovedM ||
                     std::abs(wrap_angle(pose.yaw_rad - from_.yaw_rad)) >= kMovedRad;
  const bool held = told && told_ && !moved && clock - since_ >= kPatience;
  if (!told || !told_ || moved || held) {
    from_ = pose;
    since_ = clock;
  }
  told_ = told;
  return held;
}

}  // namespace cairn::agent
