#include "robot_agent/input/passers_by.h"

#include <algorithm>
#include <cmath>

namespace cairn::agent {

PassersBy::PassersBy(const std::vector<PasserBy>& all) {
  for (const PasserBy& who : all) walkers_.push_back({who, who.from_m});
}

void PassersBy::step(double dt_s, const Pose& T_site_robot) {
  const Eigen::Vector2d robot_m(T_site_robot.x_m, T_site_robot.y_m);
  for (Walker& walker : walkers_) walk(walker, dt_s, robot_m);
}

void PassersBy::walk(Walker& walker, double dt_s, const Eigen::Vector2d& robot_m) {
  const double way_m = walker.who.speed_m_s * dt_s;
  const Eigen::Vector2d& aim_m = walker.going_back ? walker.who.from_m : walker.who.to_m;
  const Eigen::Vector2d left = aim_m - walker.at_m;
  const double left_m = left.norm();
  if (left_m <= way_m) {
    walker.at_m = aim_m;
    walker.going_back = !walker.going_back;
    return;
  }
  const Eigen::Vector2d next_m = walker.at_m + left * (way_m / left_m);
  const bool nearer = (next_m - robot_m).norm() < (walker.at_m - robot_m).norm();
  if (nearer && (next_m - robot_m).norm() < kRoomM) {
    walker.waited_s += dt_s;
    if (walker.waited_s < kPatienceS) return;
    walker.waited_s = 0.0;
    walker.going_back = !walker.going_back;
    return;
  }
  walker.waited_s = 0.0;
  walker.at_m = next_m;
}

double PassersBy::range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                          double max_range_m) const {
  double range_m = max_range_m;
  const Eigen::Vector2d along = direction.head<2>();
  const double along2 = along.squaredNorm();
  if (along2 < 1e-12) return range_m;
  for (const Walker& walker : walkers_) {
    const PasserBy& who = walker.who;
    const Eigen::Vector2d off = origin.head<2>() - walker.at_m;
    const double b = off.dot(along);
    const double root = b * b - along2 * (off.squaredNorm() - who.radius_m * who.radius_m);
    if (root < 0.0) continue;
    const double enters_m = (-b - std::sqrt(root)) / along2;
    if (enters_m < 0.0 || origin.z() + enters_m * direction.z() > who.top_m) continue;
    range_m = std::min(range_m, enters_m);
  }
  return range_m;
}

bool PassersBy::touched_by(const Pose& T_site_robot, double length_m, double width_m) const {
  const double c = std::cos(T_site_robot.yaw_rad);
  const double s = std::sin(T_site_robot.yaw_rad);
  return std::any_of(walkers_.begin(), walkers_.end(), [&](const Walker& walker) {
    const double dx = walker.at_m.x() - T_site_robot.x_m;
    const double dy = walker.at_m.y() - T_site_robot.y_m;
    const double out_x = std::max(0.0, std::abs(c * dx + s * dy) - 0.5 * length_m);
    const double out_y = std::max(0.0, std::abs(c * dy - s * dx) - 0.5 * width_m);
    return std::hypot(out_x, out_y) < walker.who.radius_m;
  });
}

}  // namespace cairn::agent
