#pragma once

#include <memory>
#include <string>

#include "core/common/result.h"
#include "robot_agent/input/input.h"

namespace cairn::agent {

/// What a 2-D log does not say about its robot.
struct LogConfig {
  /// [m] Readings at or above it are "no return" (a SICK LMS writes 81.83). [Limit: 1 … 200]
  double max_range_m = 30.0;
  /// [m] Height of the scan plane above the ground. [Limit: 0 … 3]
  double laser_height_m = 0.30;
};

/// Every fault of the configuration in one sentence each, joined by "; ". Empty when it is sound.
[[nodiscard]] std::string faults(const LogConfig& config);

/// Replays a CARMEN log (plain, gzip or bzip2, told by its first bytes), line by line.
///
/// Read are ODOM, FLASER (old format) and ROBOTLASER1; other messages are skipped. Each of them
/// gives a MotionReading (of FLASER odom_x, odom_y, odom_theta; of ROBOTLASER1 the robot pose); the
/// laser lines give a Scan with the same stamp after it. A 2-D log has no gyro and no inclinometer:
/// the odometer's own heading change stands in for the gyro, roll and pitch are 0. Where that rate
/// changes there are two MotionReadings with one stamp, with the rate before and after, so that it
/// adds up to the odometer's heading however it is integrated.
///
/// FLASER beams cover 180° from -90°: in steps of 180°/n when n is even (180, 360), of 180°/(n-1)
/// when it is odd (181, 361). `start()` is the site origin.
///
/// Time starts at 0 and never goes back. Readings out of order by up to 2 s are put in order; a
/// jump of the logger's clock beyond that, or ahead by more than 10 min, counts as 0.1 s. A log
/// whose first 256 readings carry no usable stamps is replayed in file order, 0.1 s apart.
///
/// Errors are final. When opening: no such file, nothing to replay, a faulty configuration. With
/// the line's number, when opening or later: a known message that is malformed (a count or number
/// that is not one, a position beyond 100 km, a range below 0, another number of beams), a line
/// longer than 256 kB, a file cut off in mid-line or in mid-stream, more than 4 GiB unpacked.
[[nodiscard]] Result<std::unique_ptr<Input>> open_carmen_log(const std::string& path,
                                                             const LogConfig& config);

}  // namespace cairn::agent
