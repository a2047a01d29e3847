#pragma once

#include "core/common/time.h"
#include "core/pose/pose.h"
#include "robot_agent/input/input.h"

namespace cairn::agent {

/// Notices that the robot does not move though it is told to: something that its map does not show
/// holds it.
class Stall {
 public:
  /// Commands below these are none.
  static constexpr double kLeastSpeedMS = 0.03;
  static constexpr double kLeastTurnRadS = 0.1;
  /// Who gets less far than this in that time is held.
  static constexpr double kMovedM = 0.03;
  static constexpr double kMovedRad = 0.05;
  static constexpr Duration kPatience = std::chrono::seconds(3);

  /// `command` is what the robot was told at `pose`. True once when it is held.
  bool step(const Pose& pose, const DriveCommand& command, MonotonicTime clock);

 private:
  Pose from_;
  MonotonicTime since_{};
  bool told_ = false;
};

}  // namespace cairn::agent
