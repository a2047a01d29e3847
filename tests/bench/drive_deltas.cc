#include "tests/bench/drive_deltas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "core/common/angle.h"
#include "core/delta/block.h"
#include "core/map/update.h"
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

/// Maps scans and tells the changes.
class Teller {
 public:
  Teller(const DriveSetting& setting, Drive& drive)
      : setting_(setting), drive_(drive), integrator_(SensorModel{}), submap_({1, 1}, {}, 125) {}

  void take(const Scan& scan, const LaserSpec& laser, const Pose& pose) {
    const auto effect = integrator_.integrate(
        drive_.exact, beams_in_site(scan, laser, pose, setting_.range_m), std::nullopt, nullptr);
    std::vector<CellIndex> told;
    for (const CellIndex at : effect.changed) {
      const Cell before = submap_.surface.cell(at);
      const Cell now = coarse(drive_.exact.cell(at), before, setting_.coarseness);
      const bool same = now == before || (!now.known() && !before.known());
      if (!same && submap_.surface.set(at, now)) told.push_back(at);
    }
    versions_.touch(EvidenceLayer::surface, told);
  }

  /// The blocks that changed since the last call.
  void tell() {
    Delta delta;
    for (const auto& [key, block] : versions_.blocks()) {
      std::uint32_t& last = told_[key];
      if (block.version == last) continue;
      delta.push_back({1, key, last, block.version, versions_.changes_since(key, last, submap_)});
      last = block.version;
      versions_.told(key);
    }
    if (delta.empty()) return;
    std::ranges::sort(delta, {}, &proto::BlockUpdate::key);
    drive_.deltas.push_back(std::move(delta));
  }

  [[nodiscard]] const HeightMap& told() const { return submap_.surface; }

 private:
  DriveSetting setting_;
  Drive& drive_;
  ScanIntegrator integrator_;
  Submap submap_;
  SubmapVersions versions_;
  std::unordered_map<BlockKey, std::uint32_t, BlockKeyHash> told_;  ///< Version told, by block.
};

}  // namespace

Result<Drive> drive_deltas(const DriveSetting& setting) {
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

  Drive drive;
  Teller teller(setting, drive);
  Driver driver(way, surface);
  Pose last = (*robot)->truth()->T_site_robot;
  double next_s = setting.cadence_s;
  while (true) {
    const MonotonicTime now = *(*robot)->next_stamp();
    if (to_seconds(now) > setting.duration_s) break;
    if (to_seconds(now) >= next_s) {
      teller.tell();
      next_s += setting.cadence_s;
    }
    auto readings = (*robot)->advance(now);
    if (!readings) return readings.error();
    const Pose pose = (*robot)->truth()->T_site_robot;
    for (const agent::Reading& reading : *readings) {
      const Scan* scan = std::get_if<Scan>(&reading);
      if (scan != nullptr) teller.take(*scan, (*robot)->lasers()[scan->laser], pose);
    }
    drive.way_m += std::hypot(pose.x_m - last.x_m, pose.y_m - last.y_m);
    last = pose;
    (*robot)->drive(driver.command(pose, to_seconds(now)));
  }
  teller.tell();
  drive.told = teller.told();
  return drive;
}

}  // namespace cairn::bench
