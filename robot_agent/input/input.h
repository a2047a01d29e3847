#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/common/result.h"
#include "core/common/time.h"
#include "core/pose/dead_reckoning.h"
#include "core/pose/pose.h"
#include "core/sensor/laser.h"

namespace cairn::agent {

/// One thing the robot's instruments said.
using Reading = std::variant<MotionReading, Scan>;

/// What the driver wants the wheels to do; held until the next one.
struct DriveCommand {
  double speed_m_s = 0.0;        ///< Forward.
  double turn_rate_rad_s = 0.0;  ///< Counter-clockwise.
};

/// Only a simulator knows.
struct Truth {
  Pose T_site_robot;
  int collisions = 0;  ///< Contacts with a step above the climb limit, or drops below it.
};

/// Where readings come from and drive commands go to: a simulator, a log, later ROS 2 topics.
/// Time is the input's own, starting at 0; who runs it decides how fast it passes.
class Input {
 public:
  Input() = default;
  virtual ~Input() = default;
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  [[nodiscard]] virtual const std::vector<LaserSpec>& lasers() const = 0;
  /// Where the robot stands at time 0, in the site frame.
  [[nodiscard]] virtual Pose start() const = 0;
  /// The readings up to `until`, in order of their stamps. An error is final (a log that turns out
  /// to be truncated).
  virtual Result<std::vector<Reading>> advance(MonotonicTime until) = 0;
  /// Nothing will come any more (end of a log).
  [[nodiscard]] virtual bool finished() const = 0;
  /// Stamp of the next reading, for inputs that need not keep pace with a clock (logs).
  [[nodiscard]] virtual std::optional<MonotonicTime> next_stamp() const = 0;
  /// Ignored by inputs that cannot drive.
  virtual void drive(const DriveCommand& command) = 0;
  [[nodiscard]] virtual bool can_drive() const = 0;
  [[nodiscard]] virtual std::optional<Truth> truth() const = 0;
};

}  // namespace cairn::agent
