#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/common/result.h"
#include "core/delta/coarseness.h"
#include "core/pose/pose.h"
#include "core/sensor/laser.h"

namespace cairn::bench {

/// How a drive is mapped and cut into changes.
struct DriveSetting {
  std::string world = "block";  ///< block, hill or room.
  std::uint64_t seed = 1;
  double duration_s = 300.0;
  double cadence_s = 1.0;
  double range_m = 30.0;  ///< Beams count this far.
  Coarseness coarseness;
};

/// What comes of a drive, in the order of time.
struct DriveEvents {
  std::function<void(const Scan& scan, const LaserSpec& laser, const Pose& truth)> on_scan;
  std::function<void()> on_cadence;  ///< Each cadence, and at the end.
};

/// Drives a simulated robot with two lasers about at 1 m/s.
[[nodiscard]] Status drive_about(const DriveSetting& setting, const DriveEvents& events);

}  // namespace cairn::bench
