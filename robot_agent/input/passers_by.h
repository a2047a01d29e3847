#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/pose/pose.h"

namespace cairn::agent {

/// Somebody who walks to and fro between two places: an upright cylinder.
struct PasserBy {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
  double speed_m_s = 0.8;  ///< [m/s] 0: stands at `from_m`.
  double radius_m = 0.25;
  double top_m = 1.8;  ///< [m] Height of the top in the site frame.
};

/// All who are about in a simulated world. They see the robot and stop short of it (who touches
/// whom is the robot's doing); who has waited for a while turns round.
class PassersBy {
 public:
  explicit PassersBy(const std::vector<PasserBy>& all);

  /// Moves on for a short time.
  void step(double dt_s, const Pose& T_site_robot);
  /// [m] Range to the nearest along the unit vector `direction`, at most `max_range_m`.
  [[nodiscard]] double range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                               double max_range_m) const;
  /// Whether a rectangle around the robot's middle, along its axes, touches anybody.
  [[nodiscard]] bool touched_by(const Pose& T_site_robot, double length_m, double width_m) const;

  /// [m] They keep this far from the robot's middle.
  static constexpr double kRoomM = 1.3;
  static constexpr double kPatienceS = 3.0;  ///< [s]

 private:
  struct Walker {
    PasserBy who;
    Eigen::Vector2d at_m;
    bool going_back = false;
    double waited_s = 0.0;
  };
  static void walk(Walker& walker, double dt_s, const Eigen::Vector2d& robot_m);

  std::vector<Walker> walkers_;
};

}  // namespace cairn::agent
