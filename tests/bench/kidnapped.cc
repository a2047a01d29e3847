#include "tests/bench/kidnapped.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <utility>
#include <variant>

#include "core/common/angle.h"
#include "core/map/update.h"
#include "core/pose/dead_reckoning.h"
#include "core/sensor/laser.h"
#include "robot_agent/input/noise.h"
#include "robot_agent/input/ray_caster.h"
#include "robot_agent/input/simulator.h"
#include "robot_agent/input/vehicle.h"

namespace cairn::bench {
namespace {

constexpr double kStepM = 0.25;
constexpr double kHighestStepM = 0.2;
constexpr double kSeeFreeM = 15.0;

/// One sweep of a laser from a true pose.
Scan sweep(const agent::RayCaster& caster, const LaserSpec& laser, const Pose& T_site_robot,
           agent::Noise& noise) {
  constexpr double kRangeSigmaM = 0.015;
  const Eigen::Isometry3d T = to_transform(T_site_robot) * to_transform(laser.T_robot_sensor);
  Scan scan;
  for (int i = 0; i < laser.beam_count; ++i) {
    const double angle = laser.first_angle_rad + i * laser.step_rad;
    const Eigen::Vector3d direction =
        T.linear() * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    const double range_m = caster.range_m(T.translation(), direction, laser.max_range_m);
    const bool hit = range_m < laser.max_range_m;
    scan.range_m.push_back(
        static_cast<float>(hit ? range_m + kRangeSigmaM * noise.normal() : range_m));
  }
  return scan;
}

/// A lane through the world, one pose after the other.
struct Lane {
  double x_m, y_m, yaw_rad;
};

std::vector<Lane> lanes(const agent::World& world) {
  constexpr double kApartM = 3.0;
  std::vector<Lane> all;
  int count = 0;
  for (double y = world.surface.south_m() + 0.7; y < world.surface.north_m(); y += kApartM) {
    const bool east = count++ % 2 == 0;
    all.push_back(
        {east ? world.surface.west_m() : world.surface.east_m(), y, east ? 0.0 : std::numbers::pi});
  }
  for (double x = world.surface.west_m() + 0.7; x < world.surface.east_m(); x += kApartM) {
    const bool north = count++ % 2 == 0;
    all.push_back({x, north ? world.surface.south_m() : world.surface.north_m(),
                   (north ? 0.5 : -0.5) * std::numbers::pi});
  }
  return all;
}

}  // namespace

Walkable::Walkable(const agent::World& world)
    : west_m_(world.surface.west_m()),
      south_m_(world.surface.south_m()),
      columns_(static_cast<int>((world.surface.east_m() - west_m_) / kStepM)),
      rows_(static_cast<int>((world.surface.north_m() - south_m_) / kStepM)),
      reached_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0) {
  std::deque<std::pair<double, double>> edge{{world.start.x_m, world.start.y_m}};
  reached_[*cell(world.start.x_m, world.start.y_m)] = 1;
  while (!edge.empty()) {
    const auto [x, y] = edge.front();
    edge.pop_front();
    const double here_m = world.surface.height_m(x, y);
    for (const auto& [dx, dy] :
         {std::pair{kStepM, 0.0}, {-kStepM, 0.0}, {0.0, kStepM}, {0.0, -kStepM}}) {
      const auto next = cell(x + dx, y + dy);
      if (!next || reached_[*next] != 0) continue;
      if (std::abs(world.surface.height_m(x + dx, y + dy) - here_m) > kHighestStepM) continue;
      reached_[*next] = 1;
      edge.emplace_back(x + dx, y + dy);
    }
  }
}

std::optional<std::size_t> Walkable::cell(double x_m, double y_m) const {
  const auto column = static_cast<int>(std::floor((x_m - west_m_) / kStepM));
  const auto row = static_cast<int>(std::floor((y_m - south_m_) / kStepM));
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return std::nullopt;
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
         static_cast<std::size_t>(column);
}

bool Walkable::at(double x_m, double y_m) const {
  const auto there = cell(x_m, y_m);
  return there && reached_[*there] != 0;
}

HeightMap surveyed(const agent::World& world, const Walkable& walkable, const Mapped& mapped,
                   std::uint64_t seed) {
  constexpr double kEveryM = 0.3;
  HeightMap map(125);
  ScanIntegrator integrator(SensorModel{});
  const agent::RayCaster caster(world.surface);
  agent::Noise noise(seed, 77);
  const double side_m = world.surface.east_m() - world.surface.west_m();
  for (const Lane& lane : lanes(world)) {
    for (double along = 0.7; along < side_m; along += kEveryM) {
      const Pose wanted{lane.x_m + along * std::cos(lane.yaw_rad),
                        lane.y_m + along * std::sin(lane.yaw_rad),
                        0.0,
                        0.0,
                        0.0,
                        lane.yaw_rad};
      if (!walkable.at(wanted.x_m, wanted.y_m) || !mapped(wanted.x_m, wanted.y_m)) continue;
      const agent::Vehicle vehicle(agent::VehicleConfig{}, world.surface, wanted);
      if (!vehicle.stands_free(wanted.x_m, wanted.y_m, wanted.yaw_rad)) continue;
      Pose believed = vehicle.pose();
      believed.x_m += 0.02 * noise.normal();
      believed.y_m += 0.02 * noise.normal();
      believed.z_m += 0.01 * noise.normal();
      believed.yaw_rad += radians(0.15) * noise.normal();
      for (const LaserSpec& laser : atrv_jr_lasers()) {
        const Scan scan = sweep(caster, laser, vehicle.pose(), noise);
        integrator.integrate(map, beams_in_site(scan, laser, believed, kSeeFreeM), std::nullopt,
                             nullptr);
      }
    }
  }
  return map;
}

namespace {

/// A free place with some room.
std::optional<Pose> place_for(const agent::World& world, const Walkable& walkable,
                              const Mapped& wanted, agent::Noise& noise) {
  constexpr int kTries = 20'000;
  const double kMostTiltRad = radians(8.0);  // Nobody leaves it with a wheel over a kerb.
  const agent::Vehicle vehicle(agent::VehicleConfig{}, world.surface, world.start);
  for (int i = 0; i < kTries; ++i) {
    const double x = noise.uniform(world.surface.west_m() + 1.0, world.surface.east_m() - 1.0);
    const double y = noise.uniform(world.surface.south_m() + 1.0, world.surface.north_m() - 1.0);
    const double yaw = noise.uniform(-std::numbers::pi, std::numbers::pi);
    if (!walkable.at(x, y) || !wanted(x, y) || !vehicle.stands_free(x, y, yaw)) continue;
    const Pose place{x, y, 0.0, 0.0, 0.0, yaw};
    const Pose stands = agent::Vehicle(agent::VehicleConfig{}, world.surface, place).pose();
    if (std::max(std::abs(stands.roll_rad), std::abs(stands.pitch_rad)) < kMostTiltRad) {
      return place;
    }
  }
  return std::nullopt;
}

/// Drives until enough was seen.
class Looking {
 public:
  Looking(agent::Input& robot, agent::Noise& noise)
      : robot_(robot),
        turned_(noise.uniform() < 0.5),
        way_m_(noise.uniform(1.0, 3.0)),
        bend_rad_s_(noise.uniform(-0.15, 0.15)) {}

  Result<Sighting> look() {
    constexpr MonotonicTime kLongest = std::chrono::seconds(20);  // It may be stuck.
    Sighting sighting;
    while (!done_ && *robot_.next_stamp() < kLongest) {
      auto readings = robot_.advance(*robot_.next_stamp());
      if (!readings) return readings.error();
      for (const agent::Reading& reading : *readings) take(reading, sighting);
      robot_.drive(command());
    }
    sighting.T_submap_robot = pose_.pose();
    sighting.T_site_robot = robot_.truth()->T_site_robot;
    sighting.turned = turned_;
    return sighting;
  }

 private:
  void take(const agent::Reading& reading, Sighting& sighting) {
    if (const auto* motion = std::get_if<MotionReading>(&reading)) {
      take_motion(*motion, sighting);
    } else if (const auto* scan = std::get_if<Scan>(&reading)) {
      take_scan(*scan, sighting);
    }
  }

  void take_motion(const MotionReading& motion, Sighting& sighting) {
    const Pose before = pose_.pose();
    pose_.update(motion);
    const Pose& now = pose_.pose();
    driven_m_ += std::hypot(now.x_m - before.x_m, now.y_m - before.y_m);
    turned_rad_ += std::abs(wrap_angle(now.yaw_rad - before.yaw_rad));
    done_ = turned_ ? turned_rad_ > std::numbers::pi : driven_m_ > way_m_;
    if (lurched(before, to_seconds(motion.stamp - last_))) begin_again(sighting);
    last_ = motion.stamp;
  }

  /// A wheel dropped off a kerb, or climbed one: what was seen before lies at another height.
  bool lurched(const Pose& before, double dt_s) {
    constexpr double kSmoothS = 0.4;  // The noise of the readings is no motion.
    constexpr double kLurchRadS = 0.15;
    if (dt_s <= 0.0) return false;
    const Eigen::Vector2d rate((pose_.pose().roll_rad - before.roll_rad) / dt_s,
                               (pose_.pose().pitch_rad - before.pitch_rad) / dt_s);
    tilting_rad_s_ += (rate - tilting_rad_s_) * (1.0 - std::exp(-dt_s / kSmoothS));
    return tilting_rad_s_.norm() > kLurchRadS;
  }

  void begin_again(Sighting& sighting) {
    sighting.short_term = HeightMap(sighting.short_term.cell_size_mm());
    driven_m_ = 0.0;
    turned_rad_ = 0.0;
    done_ = false;
  }

  void take_scan(const Scan& scan, Sighting& sighting) {
    integrator_.integrate(sighting.short_term,
                          beams_in_site(scan, robot_.lasers()[scan.laser], pose_.pose(), kSeeFreeM),
                          std::nullopt, nullptr);
  }

  agent::DriveCommand command() {
    if (robot_.truth()->collisions > 0) turned_ = true;
    if (turned_) return {.speed_m_s = 0.0, .turn_rate_rad_s = 0.4};
    return {.speed_m_s = 0.5, .turn_rate_rad_s = bend_rad_s_};
  }

  agent::Input& robot_;
  bool turned_;
  double way_m_;
  double bend_rad_s_;
  DeadReckoning pose_{DeadReckoningConfig{}, Pose{}};
  ScanIntegrator integrator_{SensorModel{}};
  Eigen::Vector2d tilting_rad_s_ = Eigen::Vector2d::Zero();
  MonotonicTime last_{};
  double driven_m_ = 0.0;
  double turned_rad_ = 0.0;
  bool done_ = false;
};

}  // namespace

Result<Sighting> put_down(const agent::World& world, const Walkable& walkable, const Mapped& wanted,
                          std::uint64_t seed) {
  agent::Noise noise(seed, 78);
  const auto place = place_for(world, walkable, wanted, noise);
  if (!place) return Error{ErrorCode::unavailable, "there is no free place"};
  agent::World there = world;
  there.start = *place;
  agent::SimulatorConfig config;
  config.world = world.name;
  config.seed = seed;
  auto robot = agent::make_simulator(config, std::move(there));
  if (!robot) return robot.error();
  return Looking(**robot, noise).look();
}

}  // namespace cairn::bench
