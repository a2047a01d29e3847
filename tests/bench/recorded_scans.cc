#include "tests/bench/recorded_scans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <variant>

#include "core/common/angle.h"
#include "core/map/update.h"
#include "robot_agent/input/simulator.h"

namespace cairn::bench {
namespace {

// How far emptiness behind a missing return is believed.
constexpr double kFreeRangeM = 8.0;
// A lap takes about a minute and a half; a robot that got stuck must not run for ever.
constexpr MonotonicTime kLongestLap = std::chrono::minutes(5);

/// Drives around the square whose first corner is where the robot stood at the start.
class LapDriver {
 public:
  LapDriver(const Pose& start, int laps) : start_(start), corners_left_(4 * laps) {}

  [[nodiscard]] bool done() const { return corners_left_ == 0; }

  agent::DriveCommand command(const Pose& pose) {
    const std::array<double, 2> corner = kCorners[next_ % kCorners.size()];
    const double dx = start_.x_m + corner[0] - pose.x_m;
    const double dy = start_.y_m + corner[1] - pose.y_m;
    if (std::hypot(dx, dy) < 0.3) {
      ++next_;
      --corners_left_;
    }
    const double off = wrap_angle(std::atan2(dy, dx) - pose.yaw_rad);
    const double speed = std::abs(off) < radians(20) ? 0.5 : 0.0;
    return {.speed_m_s = speed, .turn_rate_rad_s = std::clamp(2.0 * off, -0.6, 0.6)};
  }

 private:
  static constexpr std::array<std::array<double, 2>, 4> kCorners{
      {{8.0, 0.0}, {8.0, 8.0}, {0.0, 8.0}, {0.0, 0.0}}};

  Pose start_;
  int corners_left_;
  std::size_t next_ = 0;
};

void place_scans(const std::vector<agent::Reading>& readings, const std::vector<LaserSpec>& lasers,
                 const Pose& T_site_robot, std::vector<PlacedScan>& scans) {
  for (const agent::Reading& reading : readings) {
    const Scan* scan = std::get_if<Scan>(&reading);
    if (scan == nullptr) continue;
    scans.push_back(
        {scan->laser, beams_in_site(*scan, lasers[scan->laser], T_site_robot, kFreeRangeM)});
  }
}

}  // namespace

Result<std::vector<PlacedScan>> scans_of_room_laps(int laps, std::uint64_t seed) {
  agent::SimulatorConfig config;
  config.world = "room";
  config.seed = seed;
  auto simulator = agent::make_simulator(config);
  if (!simulator) return simulator.error();
  agent::Input& robot = **simulator;

  std::vector<PlacedScan> scans;
  LapDriver driver(robot.start(), laps);
  while (!driver.done()) {
    const std::optional<MonotonicTime> now = robot.next_stamp();
    if (!now || *now > laps * kLongestLap) {
      return Error{ErrorCode::unavailable, "the robot did not finish its laps; try another seed"};
    }
    auto readings = robot.advance(*now);
    if (!readings) return readings.error();
    const Pose T_site_robot = robot.truth()->T_site_robot;
    place_scans(*readings, robot.lasers(), T_site_robot, scans);
    robot.drive(driver.command(T_site_robot));
  }
  return scans;
}

HeightMap map_of(const std::vector<PlacedScan>& scans, int cell_size_mm) {
  HeightMap map(cell_size_mm);
  ScanIntegrator integrator(SensorModel{});
  for (const PlacedScan& scan : scans) {
    integrator.integrate(map, scan.beams, std::nullopt, nullptr);
  }
  return map;
}

}  // namespace cairn::bench
