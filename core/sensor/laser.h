#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/common/angle.h"
#include "core/common/time.h"
#include "core/pose/pose.h"

namespace cairn {

/// A planar laser scanner on the robot (T3.1, T3.4).
struct LaserSpec {
  Pose T_robot_sensor;                      ///< Mount: scan plane is the sensor's x-y plane.
  int beam_count = 181;                     ///< [Limit: 1 … kMaxBeams]
  double first_angle_rad = radians(-90.0);  ///< Angle of beam 0 from the sensor's x axis.
  double step_rad = radians(1.0);           ///< Angle between beams; negative turns clockwise.
  double min_range_m = 0.1;
  double max_range_m = 30.0;  ///< A reading at or above it is "no return".
  /// Planar scanner on flat ground (replay of 2-D logs): the free part of each beam is taken as
  /// ground at the robot's foot, the hit as an obstacle as high as the beam.
  bool ground_along_beam = false;

  static constexpr int kMaxBeams = 4096;
};

/// The two SICK scanners of the ATRV-Jr (T3.1): one level, one looking 22° down.
[[nodiscard]] std::vector<LaserSpec> atrv_jr_lasers();

/// One sweep of one laser. `range_m[i]` ≥ max_range_m, or not finite, means no return.
struct Scan {
  MonotonicTime stamp{};
  std::size_t laser = 0;  ///< Index into the robot's list of LaserSpec.
  std::vector<float> range_m;
};

/// A beam in the site frame.
struct Beam {
  Eigen::Vector3d origin_m;
  Eigen::Vector3d end_m;  ///< The hit, or the end of the trusted free part when there is no hit.
  bool hit = false;
};

/// Turns a scan into beams by T_site_robot · T_robot_sensor · Trans(x, y, 0) (T3.4, Eq. 9-10).
/// Beams below min range or not a number are left out; beams without return end at
/// `free_range_m` (how far emptiness is believed) and have hit = false. Ranges beyond the spec's
/// beam count are ignored.
[[nodiscard]] std::vector<Beam> beams_in_site(const Scan& scan, const LaserSpec& spec,
                                              const Pose& T_site_robot, double free_range_m);

}  // namespace cairn
