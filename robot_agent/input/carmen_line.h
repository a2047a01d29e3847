#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/common/result.h"
#include "core/sensor/laser.h"

namespace cairn::agent {

/// The angles of a planar laser's beams; the angle is from straight ahead, counter-clockwise.
struct BeamAngles {
  double first_rad = 0.0;
  double step_rad = 0.0;
};

/// One message of a CARMEN log that can be replayed.
struct CarmenMessage {
  double x_m = 0.0;  ///< Odometry, in its own frame.
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double stamp_s = 0.0;  ///< By the logger's clock.
  BeamAngles angles;
  std::vector<float> range_m;  ///< Empty in ODOM messages.
};

/// Understands one line: ODOM, FLASER or ROBOTLASER1; nothing for comments and other messages.
/// Errors: what is wrong with a known message, without the line's number.
[[nodiscard]] Result<std::optional<CarmenMessage>> parse_carmen_line(std::string_view line);

}  // namespace cairn::agent
