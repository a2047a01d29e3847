#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "robot_agent/input/simulator.h"
#include "robot_agent/pipeline/mapper.h"
#include "robot_agent/pipeline/submap_frame.h"

/// The map maker in the simulator's worlds, with the instruments' and lasers' noise.
namespace cairn::agent {
namespace {

using Way = std::vector<Eigen::Vector2d>;

/// A robot of one world that drives by the truth and maps by what it believes.
class Drive {
 public:
  Drive(const std::string& world, std::uint64_t seed, const MapperConfig& config,
        const HeightMap* given = nullptr, Pose believed_off = {})
      : input_(make(world, seed)),
        mapper_(config, input_->lasers(), compose(input_->truth()->T_site_robot, believed_off),
                seed, evidence_) {
    if (given == nullptr) return;
    std::vector<GivenTile> tiles;
    for (const auto& [key, tile] : given->tiles()) tiles.push_back({key, *tile, 0});
    mapper_.take_tiles(tiles);
  }

  void along(const Way& way) {
    for (const Eigen::Vector2d& to : way) {
      const MonotonicTime until = now_ + std::chrono::minutes(3);
      while (distance_to(to) > 0.2 && now_ < until) tick(steer(to));
    }
  }
  void stand(int ticks) {
    for (int i = 0; i < ticks; ++i) tick({});
  }

  [[nodiscard]] Mapper& mapper() { return mapper_; }
  [[nodiscard]] proto::EvidenceSender& evidence() { return evidence_; }
  [[nodiscard]] Pose truth() const { return input_->truth()->T_site_robot; }
  [[nodiscard]] double error_m() const {
    return std::hypot(truth().x_m - mapper_.pose().x_m, truth().y_m - mapper_.pose().y_m);
  }
  [[nodiscard]] double error_rad() const {
    return std::abs(wrap_angle(truth().yaw_rad - mapper_.pose().yaw_rad));
  }

 private:
  static std::unique_ptr<Input> make(const std::string& world, std::uint64_t seed) {
    SimulatorConfig config;
    config.world = world;
    config.seed = seed;
    auto input = make_simulator(config);
    EXPECT_TRUE(input) << (input ? "" : input.error().message);
    return std::move(*input);
  }
  [[nodiscard]] double distance_to(const Eigen::Vector2d& to) const {
    return std::hypot(to.x() - truth().x_m, to.y() - truth().y_m);
  }
  [[nodiscard]] DriveCommand steer(const Eigen::Vector2d& to) const {
    const double off =
        wrap_angle(std::atan2(to.y() - truth().y_m, to.x() - truth().x_m) - truth().yaw_rad);
    return {.speed_m_s = std::abs(off) < radians(20.0) ? 0.5 : 0.0,
            .turn_rate_rad_s = std::clamp(2.0 * off, -0.6, 0.6)};
  }
  void tick(const DriveCommand& command) {
    input_->drive(command);
    now_ += std::chrono::milliseconds(50);
    const auto readings = input_->advance(now_);
    for (const Reading& reading : *readings) {
      if (const auto* motion = std::get_if<MotionReading>(&reading)) mapper_.take_motion(*motion);
      if (const auto* scan = std::get_if<Scan>(&reading)) mapper_.take_scan(*scan);
    }
  }

  std::unique_ptr<Input> input_;
  proto::EvidenceSender evidence_;
  Mapper mapper_;
  MonotonicTime now_{};
};

MapperConfig tuned() {
  MapperConfig c;
  if (const char* v = std::getenv("OA")) c.old_after_m = std::atof(v);
  if (const char* v = std::getenv("OS")) c.old_share = std::atof(v);
  if (const char* v = std::getenv("SD")) c.submap_distance_m = std::atof(v);
  return c;
}

const Way kLap{{10.5, 2.5}, {10.5, 10.5}, {2.5, 10.5}, {2.5, 2.5}};

MapperConfig without_localization() {
  MapperConfig config;
  config.localize = false;
  return config;
}

TEST(ZMapperWorlds, Measure) {
  const std::string world = std::getenv("WORLD");
  Way way = kLap;
  if (world == "ramp") way = {{10.0, 10.3}, {19.5, 10.3}, {24.3, 10.0}, {24.3, 8.2}, {19.5, 9.3}, {10.0, 9.3}, {4.0, 8.5}};
  if (world == "block") way = {{-22.0, -22.0}, {22.0, -22.0}, {22.0, 22.0}, {-22.0, 22.0}, {-22.0, -22.0}};
  if (world == "hill") way = {{7.0, 0.0}, {7.0, 7.0}, {-7.0, 7.0}, {-7.0, -7.0}, {7.0, -7.0}, {7.0, 0.0}, {0.0,0.0}};
  const int seeds = std::getenv("SEEDS") ? std::atoi(std::getenv("SEEDS")) : 3;
  for (int seed = 11; seed < 11 + seeds; ++seed) {
    Drive with(world, seed, tuned());
    Drive without(world, seed, without_localization());
    with.along(way); without.along(way);
    std::cout << world << " " << seed << ": " << with.error_m() << " m z " << with.truth().z_m - with.mapper().pose().z_m << " " << degrees(with.error_rad()) << " deg / "
              << without.error_m() << " m z " << without.truth().z_m - without.mapper().pose().z_m << " " << degrees(without.error_rad()) << " deg; acc "
              << with.mapper().corrections_accepted() << " ref "
              << with.mapper().corrections_refused() << " way " << with.mapper().distance_m() << " "<< with.mapper().localization_why() << " sigma " << with.mapper().position_sigma_m() << " end " << with.truth().x_m << " " << with.truth().y_m << std::endl;
  }
}

TEST(MapperDrive, EndsALapOfTheRoomNearerToTheTruthThanByDeadReckoning) {
  double with_m = 0.0;
  double without_m = 0.0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Drive with("room", seed, tuned());
    Drive without("room", seed, without_localization());
    for (Drive* drive : {&with, &without}) {
      drive->along(kLap);
      drive->along({{8.0, 2.5}});
    }
    EXPECT_GT(with.mapper().corrections_accepted(), 0U) << seed;
    EXPECT_NE(with.mapper().localization(), LocalizationState::lost) << seed;
    EXPECT_LT(with.error_m(), 0.3) << seed;
    with_m += with.error_m();
    without_m += without.error_m();
    std::cout << seed << ": " << with.error_m() << " m " << with.error_rad() << " / "
              << without.error_m() << " m " << without.error_rad() << " acc "
              << with.mapper().corrections_accepted() << " ref "
              << with.mapper().corrections_refused() << " " << with.mapper().localization_why()
              << '\n';
  }
  EXPECT_LT(with_m, 0.5 * without_m);
}

}  // namespace
}  // namespace cairn::agent
