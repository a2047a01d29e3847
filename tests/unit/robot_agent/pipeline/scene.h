#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/pose/pose.h"
#include "core/sensor/laser.h"

/// Flat ground with boxes on it, and what a laser reads there: exact, without noise.
namespace cairn::agent::testing {

struct Box {
  Eigen::Vector3d lowest_m;
  Eigen::Vector3d highest_m;
};

/// A box that stands on the ground.
inline Box box(double x0, double x1, double y0, double y1, double height_m) {
  return {{x0, y0, 0.0}, {x1, y1, height_m}};
}

/// Distance along the ray to the box; nullopt when it misses.
inline std::optional<double> distance_to(const Box& box, const Eigen::Vector3d& from,
                                         const Eigen::Vector3d& along) {
  double enters = 0.0;
  double leaves = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(along[axis]) < 1e-12) {
      if (from[axis] < box.lowest_m[axis] || from[axis] > box.highest_m[axis]) return {};
      continue;
    }
    const double a = (box.lowest_m[axis] - from[axis]) / along[axis];
    const double b = (box.highest_m[axis] - from[axis]) / along[axis];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return enters <= leaves ? std::optional(enters) : std::nullopt;
}

struct Scene {
  std::vector<Box> boxes;
  double ground_m = 0.0;

  [[nodiscard]] Scan scan(const LaserSpec& laser, std::size_t index, const Pose& T_site_robot,
                          MonotonicTime stamp) const {
    const Eigen::Isometry3d T = to_transform(T_site_robot) * to_transform(laser.T_robot_sensor);
    Scan scan{.stamp = stamp, .laser = index, .range_m = {}};
    for (int i = 0; i < laser.beam_count; ++i) {
      const double angle = laser.first_angle_rad + i * laser.step_rad;
      const Eigen::Vector3d along =
          T.linear() * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
      scan.range_m.push_back(static_cast<float>(range(T.translation(), along, laser)));
    }
    return scan;
  }

 private:
  [[nodiscard]] double range(const Eigen::Vector3d& from, const Eigen::Vector3d& along,
                             const LaserSpec& laser) const {
    double nearest = laser.max_range_m;
    if (along.z() < -1e-12) nearest = std::min(nearest, (ground_m - from.z()) / along.z());
    for (const Box& each : boxes) {
      if (const auto hit = distance_to(each, from, along)) nearest = std::min(nearest, *hit);
    }
    return nearest;
  }
};

}  // namespace cairn::agent::testing
