#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/map/height_map.h"
#include "core/pose/pose.h"

namespace cairn::bench {

/// A point of a drive, in the site [m].
struct WayPoint {
  double x_m = 0.0;
  double y_m = 0.0;
};

/// One drive through a world of which the robot was given the long-term map (T4.3.3).
struct Lap {
  std::vector<Pose> truth;  ///< At each motion reading, as the two below.
  std::vector<Pose> corrected;
  std::vector<Pose> uncorrected;
  std::uint64_t corrections = 0;
  std::uint64_t refusals = 0;
  bool lost = false;  ///< At any time.
  std::string last_refusal;
};

/// The world's map as scans from true poses make it on a drive along the way points.
[[nodiscard]] Result<HeightMap> map_from_true_poses(const std::string& world, std::uint64_t seed,
                                                    const std::vector<WayPoint>& way);

/// The same drive with other noise, by the agent's own map making; somebody who sees the robot
/// steers it from way point to way point. It is given its first pose and the map.
[[nodiscard]] Result<Lap> drive_lap(const std::string& world, std::uint64_t seed,
                                    const std::vector<WayPoint>& way, const HeightMap& long_term);

/// How far a pose is off.
struct PoseError {
  double position_m = 0.0;  ///< In x and y.
  double z_m = 0.0;
  double yaw_rad = 0.0;
};
[[nodiscard]] PoseError error_of(const Pose& believed, const Pose& truth);

/// Draws the map and the three tracks: green where the robot was, blue where it believed to be, red
/// where dead reckoning alone would have had it.
[[nodiscard]] Status draw(const HeightMap& map, const Lap& lap, const std::string& file);

}  // namespace cairn::bench
