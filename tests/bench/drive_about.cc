#include "tests/bench/drive_about.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include "core/common/angle.h"
#include "robot_agent/input/simulator.h"
#include "tests/bench/world_height.h"

namespace cairn::bench {
namespace {

struct Point {
  double x_m;
  double y_m;
};
using Way = std::vector<Point>;

/// Along the roads, up and down their ends, over the ground, around the room.
Way way_through(const std::string& world) {
  if (world == "block") {
    return {{0, -22},   {22, -22},  {22, 22},   {-22, 22}, {-22, -22}, {-45, -22},
            {-22, -22}, {-22, -45}, {-22, -22}, {0, -22},  {22, -22},  {22, -45}};
  }
  if (world == "hill") {
    return {{0, 0},     {15, 5},   {30, -5},  {40, 10},  {35, 30},   {15, 38},
            {-5, 30},   {-20, 38}, {-38, 30}, {-35, 10}, {-40, -10}, {-30, -30},
            {-10, -38}, {10, -30}, {30, -38}, {38, -20}, {20, -12},  {0, -12}};
  }
  return {{2.5, 2.5}, {10.5, 2.5}, {10.5, 10.5}, {2.5, 10.5}};
}

/// Steers from point to point around what is in the way; it sees the world as it is.
class Driver {
 public:
  Driver(Way way, const agent::HeightRaster& surface) : way_(std::move(way)), ground_(surface) {}

  agent::DriveCommand command(const Pose& pose, double now_s) {
    const Point& goal = way_[next_ % way_.size()];
    const double away_m = std::hypot(goal.x_m - pose.x_m, goal.y_m - pose.y_m);
    constexpr double kMostPerLegS = 90.0;
    if (away_m < 1.0 || now_s - since_s_ > kMostPerLegS) {
      ++next_;
      since_s_ = now_s;
    }
    const double to_goal = std::atan2(goal.y_m - pose.y_m, goal.x_m - pose.x_m);
    const double off = wrap_angle(free_heading(pose, to_goal) - pose.yaw_rad);
    const double speed = std::max(0.0, 1.0 - 1.6 * std::abs(off));
    return {.speed_m_s = speed, .turn_rate_rad_s = std::clamp(2.0 * off, -0.8, 0.8)};
  }

 private:
  [[nodiscard]] double free_heading(const Pose& pose, double wanted_rad) const {
    for (double aside = 0.0; aside < radians(150.0); aside += radians(12.0)) {
      for (const double side : {1.0, -1.0}) {
        if (free(pose, wanted_rad + side * aside)) return wanted_rad + side * aside;
      }
    }
    return wanted_rad;
  }
  [[nodiscard]] bool free(const Pose& pose, double heading_rad) const {
    constexpr double kStepM = 0.1;
    constexpr double kClimbM = 0.08;
    for (const double aside : {-0.55, -0.3, 0.0, 0.3, 0.55}) {
      double last = std::nan("");
      for (double ahead = 0.0; ahead < 1.8; ahead += kStepM) {
        const double here =
            ground_(pose.x_m + ahead * std::cos(heading_rad) - aside * std::sin(heading_rad),
                    pose.y_m + ahead * std::sin(heading_rad) + aside * std::cos(heading_rad));
        if (ahead > 0.0 && !(std::abs(here - last) < kClimbM)) return false;
        last = here;
      }
    }
    return true;
  }

  Way way_;
  WorldHeight ground_;
  std::size_t next_ = 1;
  double since_s_ = 0.0;
};

}  // namespace

Status drive_about(const DriveSetting& setting, const DriveEvents& events) {
  auto world = agent::make_world(setting.world, setting.seed);
  if (!world) return world.error();
  const Way way = way_through(setting.world);
  if (setting.world != "hill") world->start = {way[0].x_m, way[0].y_m, 0, 0, 0, 0};
  const agent::HeightRaster surface = world->surface;
  agent::SimulatorConfig config;
  config.world = setting.world;
  config.seed = setting.seed + 1000;
  auto robot = agent::make_simulator(config, *std::move(world));
  if (!robot) return robot.error();

  Driver driver(way, surface);
  double next_s = setting.cadence_s;
  while (true) {
    const MonotonicTime now = *(*robot)->next_stamp();
    if (to_seconds(now) > setting.duration_s) break;
    if (to_seconds(now) >= next_s) {
      events.on_cadence();
      next_s += setting.cadence_s;
    }
    auto readings = (*robot)->advance(now);
    if (!readings) return readings.error();
    const Pose pose = (*robot)->truth()->T_site_robot;
    for (const agent::Reading& reading : *readings) {
      const Scan* scan = std::get_if<Scan>(&reading);
      if (scan != nullptr) events.on_scan(*scan, (*robot)->lasers()[scan->laser], pose);
    }
    (*robot)->drive(driver.command(pose, to_seconds(now)));
  }
  events.on_cadence();
  return {};
}

}  // namespace cairn::bench
