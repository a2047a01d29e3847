#include "core/sensor/laser.h"

#include <algorithm>
#include <cmath>

namespace cairn {

std::vector<LaserSpec> atrv_jr_lasers() {
  LaserSpec level;
  level.T_robot_sensor = {.x_m = 0.30, .z_m = 0.40};
  LaserSpec tilted;
  tilted.T_robot_sensor = {.x_m = 0.25, .z_m = 0.75, .pitch_rad = radians(22.0)};
  return {level, tilted};
}

std::vector<Beam> beams_in_site(const Scan& scan, const LaserSpec& spec, const Pose& T_site_robot,
                                double free_range_m) {
  // Equations (9) and (10).
  const Eigen::Isometry3d T_site_sensor =
      to_transform(T_site_robot) * to_transform(spec.T_robot_sensor);
  const std::size_t count =
      std::min(scan.range_m.size(), static_cast<std::size_t>(std::max(spec.beam_count, 0)));
  std::vector<Beam> beams;
  beams.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto range_m = static_cast<double>(scan.range_m[i]);
    if (!(range_m >= spec.min_range_m)) continue;  // Also leaves out what is not a number.
    const bool hit = range_m < spec.max_range_m;
    const double length_m = hit ? range_m : free_range_m;
    const double angle = spec.first_angle_rad + static_cast<double>(i) * spec.step_rad;
    const Eigen::Vector3d p_sensor(length_m * std::cos(angle), length_m * std::sin(angle), 0.0);
    beams.push_back({T_site_sensor.translation(), T_site_sensor * p_sensor, hit});
  }
  return beams;
}

}  // namespace cairn
