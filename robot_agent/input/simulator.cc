#include "robot_agent/input/simulator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robot_agent/input/limits.h"
#include "robot_agent/input/ray_caster.h"

namespace cairn::agent {
namespace {

constexpr MonotonicTime kTick{10'000};
constexpr double kTickS = 0.01;
constexpr double kTicksPerS = 100.0;

// The ticks at which something happens `rate_hz` times a second, beginning at tick 0.
class Schedule {
 public:
  explicit Schedule(double rate_hz) : ticks_(kTicksPerS / rate_hz) {}

  [[nodiscard]] std::int64_t next_tick() const {
    // A hair less, so that 0.2 s · 5 is tick 100 and not the one after.
    return static_cast<std::int64_t>(std::ceil(static_cast<double>(count_) * ticks_ - 1e-6));
  }
  bool take(std::int64_t tick) {
    const bool due = next_tick() <= tick;
    count_ += due ? 1 : 0;
    return due;
  }

 private:
  double ticks_;
  std::int64_t count_ = 0;
};

class Simulator final : public Input {
 public:
  Simulator(const SimulatorConfig& config, World world)
      : config_(config),
        world_(std::move(world)),
        lasers_(atrv_jr_lasers()),
        caster_(world_.surface),
        vehicle_(config.vehicle, world_.surface, world_.start),
        passers_by_(world_.passers_by),
        start_(vehicle_.pose()),
        instruments_(config.instruments, config.seed, start_),
        laser_noise_(config.seed, 2),
        motion_(config.motion_rate_hz),
        scans_(config.scan_rate_hz) {}

  [[nodiscard]] const std::vector<LaserSpec>& lasers() const override { return lasers_; }
  [[nodiscard]] Pose start() const override { return start_; }
  [[nodiscard]] bool finished() const override { return false; }
  void drive(const DriveCommand& command) override { command_ = command; }
  [[nodiscard]] bool can_drive() const override { return true; }
  [[nodiscard]] std::optional<Truth> truth() const override {
    return Truth{vehicle_.pose(), vehicle_.collisions() + people_touched_};
  }
  [[nodiscard]] std::optional<MonotonicTime> next_stamp() const override {
    return kTick * std::min(motion_.next_tick(), scans_.next_tick());
  }

  Result<std::vector<Reading>> advance(MonotonicTime until) override {
    std::vector<Reading> readings;
    for (; kTick * next_tick_ <= until; ++next_tick_) {
      if (next_tick_ > 0) {
        vehicle_.step(command_, kTickS);
        meet_people();
        instruments_.follow(vehicle_, kTickS);
      }
      read_instruments(readings);
    }
    return readings;
  }

 private:
  void meet_people() {
    passers_by_.step(kTickS, vehicle_.pose());
    const bool touching =
        passers_by_.touched_by(vehicle_.pose(), config_.vehicle.length_m, config_.vehicle.width_m);
    people_touched_ += touching && !touching_ ? 1 : 0;
    touching_ = touching;
  }

  void read_instruments(std::vector<Reading>& readings) {
    const MonotonicTime now = kTick * next_tick_;
    if (motion_.take(next_tick_)) {
      readings.emplace_back(instruments_.read(now));
    }
    if (scans_.take(next_tick_)) {
      for (std::size_t laser = 0; laser < lasers_.size(); ++laser) {
        readings.emplace_back(sweep(laser, now));
      }
    }
  }

  Scan sweep(std::size_t laser, MonotonicTime now) {
    const LaserSpec& spec = lasers_[laser];
    const Eigen::Isometry3d T_site_sensor =
        to_transform(vehicle_.pose()) * to_transform(spec.T_robot_sensor);
    Scan scan{now, laser, {}};
    scan.range_m.reserve(static_cast<std::size_t>(spec.beam_count));
    for (int i = 0; i < spec.beam_count; ++i) {
      const double angle = spec.first_angle_rad + i * spec.step_rad;
      const Eigen::Vector3d direction =
          T_site_sensor.linear() * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
      const Eigen::Vector3d origin = T_site_sensor.translation();
      const double range = passers_by_.range_m(
          origin, direction, caster_.range_m(origin, direction, spec.max_range_m));
      scan.range_m.push_back(static_cast<float>(measured(range, spec)));
    }
    return scan;
  }

  double measured(double range_m, const LaserSpec& spec) {
    const double error = config_.lasers.range_sigma_m * laser_noise_.normal();
    const bool lost = laser_noise_.uniform() < config_.lasers.dropout_probability;
    if (lost || range_m >= spec.max_range_m) {
      return spec.max_range_m;
    }
    return std::clamp(range_m + error, 0.0, spec.max_range_m);
  }

  SimulatorConfig config_;
  World world_;
  std::vector<LaserSpec> lasers_;
  RayCaster caster_;
  Vehicle vehicle_;
  PassersBy passers_by_;
  bool touching_ = false;
  int people_touched_ = 0;
  Pose start_;
  Instruments instruments_;
  Noise laser_noise_;
  Schedule motion_;
  Schedule scans_;
  DriveCommand command_;
  std::int64_t next_tick_ = 0;
};

}  // namespace

std::string faults(const SimulatorConfig& c) {
  Faults faults;
  faults.check("scan_rate_hz", c.scan_rate_hz, 1e-3, 100.0);
  faults.check("motion_rate_hz", c.motion_rate_hz, 1e-3, 100.0);
  faults.add(cairn::agent::faults(c.vehicle));
  faults.add(cairn::agent::faults(c.instruments));
  faults.check("lasers.range_sigma_m", c.lasers.range_sigma_m, 0.0, 1.0);
  faults.check("lasers.dropout_probability", c.lasers.dropout_probability, 0.0, 1.0);
  return faults.text();
}

Result<std::unique_ptr<Input>> make_simulator(const SimulatorConfig& config, World world) {
  if (const std::string wrong = faults(config); !wrong.empty()) {
    return Error{ErrorCode::invalid_argument, "simulator: " + wrong};
  }
  return std::unique_ptr<Input>(std::make_unique<Simulator>(config, std::move(world)));
}

Result<std::unique_ptr<Input>> make_simulator(const SimulatorConfig& config) {
  auto world = make_world(config.world, config.seed);
  if (!world) {
    return world.error();
  }
  return make_simulator(config, std::move(*world));
}

}  // namespace cairn::agent
