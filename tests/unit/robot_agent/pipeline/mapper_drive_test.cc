#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "robot_agent/input/paint.h"
#include "robot_agent/input/simulator.h"
#include "robot_agent/pipeline/mapper.h"
#include "robot_agent/pipeline/submap_frame.h"
#include "tests/support/evidence_frames.h"

/// The map maker in the simulator's worlds, with the instruments' and lasers' noise.
namespace cairn::agent {
namespace {

using Way = std::vector<Eigen::Vector2d>;

/// A robot of one world that drives by the truth and maps by what it believes.
class Drive {
 public:
  Drive(const std::string& world, std::uint64_t seed, const MapperConfig& config,
        const HeightMap* given = nullptr, Pose believed_off = {})
      : Drive(make(make_world(world, seed).value(), seed), seed, config, given, believed_off) {}
  Drive(World world, std::uint64_t seed, const MapperConfig& config, const HeightMap* given)
      : Drive(make(std::move(world), seed), seed, config, given, {}) {}
  Drive(std::unique_ptr<Input> input, std::uint64_t seed, const MapperConfig& config,
        const HeightMap* given, Pose believed_off)
      : input_(std::move(input)),
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
  static std::unique_ptr<Input> make(World world, std::uint64_t seed) {
    SimulatorConfig config;
    config.seed = seed;
    auto input = make_simulator(config, std::move(world));
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

const Way kLap{{10.5, 2.5}, {10.5, 10.5}, {2.5, 10.5}, {2.5, 2.5}};

MapperConfig without_localization() {
  MapperConfig config;
  config.localize = false;
  return config;
}

TEST(MapperDrive, EndsALapOfTheRoomWithinACellWithoutAnyMap) {
  for (const std::uint64_t seed : {1U, 2U}) {
    Drive drive("room", seed, {});
    drive.along(kLap);
    EXPECT_LT(drive.error_m(), 0.05) << seed;
    EXPECT_LT(drive.error_rad(), radians(0.5)) << seed;
    EXPECT_EQ(drive.mapper().localization(), LocalizationState::localized) << seed;
    EXPECT_EQ(drive.mapper().corrections_refused(), 0U) << seed;
  }
}

TEST(MapperDrive, IsFarOffAfterALapByDeadReckoning) {
  Drive drive("room", 1, without_localization());
  drive.along(kLap);
  EXPECT_GT(drive.error_m(), 0.1);
  EXPECT_GT(drive.mapper().position_sigma_m(), 0.2);
}

TEST(MapperDrive, KnowsHowSureItIs) {
  Drive drive("room", 3, {});
  drive.along(kLap);
  EXPECT_LT(drive.mapper().position_sigma_m(), 0.5);
  EXPECT_LT(drive.error_m(), 3.0 * drive.mapper().position_sigma_m());
}

TEST(MapperDrive, ChainsEachSubmapToTheOneBefore) {
  Drive drive("room", 1, {});
  drive.along(kLap);
  drive.mapper().finish();
  const Replica& replica = drive.mapper().replica();
  ASSERT_GE(replica.submaps(), 4U);
  EXPECT_FALSE(replica.find(1)->link);
  for (std::uint32_t sequence = 2; sequence <= replica.submaps(); ++sequence) {
    const Submap& submap = *replica.find(sequence);
    ASSERT_TRUE(submap.link) << sequence;
    const Pose placed = compose(pose_of(replica.find(sequence - 1)->T_site_submap),
                                pose_of(submap.link->T_previous_submap));
    EXPECT_NEAR(placed.x_m, submap.T_site_submap.x_mm / 1e3, 0.01) << sequence;
    EXPECT_NEAR(placed.y_m, submap.T_site_submap.y_mm / 1e3, 0.01) << sequence;
    EXPECT_LT(submap.link->sigma_xy_mm, 300) << sequence;
    EXPECT_GT(submap.link->sigma_yaw_1e4rad, 0) << sequence;
  }
}

/// The room as a robot mapped it that knew where it was.
HeightMap map_of_room(std::uint64_t seed) {
  Drive drive("room", seed, {});
  drive.along(kLap);
  drive.mapper().finish();
  return drive.mapper().replica().now();
}

TEST(MapperDrive, StaysOnAMapThatItWasGiven) {
  const HeightMap room = map_of_room(4);
  Drive drive("room", 4, {}, &room);
  drive.along(kLap);
  EXPECT_LT(drive.error_m(), 0.06);
  EXPECT_GT(drive.mapper().corrections_accepted(), 10U);
  EXPECT_EQ(drive.mapper().localization(), LocalizationState::localized);
}

/// A yard with platforms that a robot just manages to climb, and the map of its ground.
World yard() {
  World world{"yard", HeightRaster(0.05, 401, 321, -2.0, -8.0), {}};
  put_box(world.surface, {5.0, 0.0, 4.0, 8.0, 0.4}, 0.08);
  put_box(world.surface, {12.0, 0.0, 3.0, 8.0, -0.5}, 0.09);
  for (const double y_m : {-7.0, 7.0}) put_box(world.surface, {8.0, y_m, 20.0, 0.5}, 1.0);
  return world;
}

HeightMap map_of(const World& world) {
  HeightMap map(125);
  for (double y_m = -7.5; y_m < 7.5; y_m += 0.125) {
    for (double x_m = -1.5; x_m < 17.5; x_m += 0.125) {
      const double z_m = world.surface.height_m(x_m, y_m);
      map.set(map.cell_at(x_m, y_m), {static_cast<std::int32_t>(std::lround(1000.0 * z_m)), 240});
    }
  }
  return map;
}

/// How many cells of even ground it maps as a step, that is off by more than half of one.
int false_steps(const Mapper& mapper, const HeightMap& truth) {
  int steps = 0;
  for (int y = -40; y <= 40; ++y) {
    for (int x = 0; x <= 120; ++x) {
      const std::int32_t height_mm = truth.cell({x, y}).height_mm;
      const auto level = [&](int dx, int dy) {
        return truth.cell({x + dx, y + dy}).height_mm == height_mm;
      };
      const bool even = level(-2, -2) && level(2, 2) && level(-2, 2) && level(2, -2) &&
                        level(0, 2) && level(0, -2) && level(2, 0) && level(-2, 0);
      if (even && std::abs(mapper.cell({x, y}).height_mm - height_mm) > 50) ++steps;
    }
  }
  return steps;
}

TEST(MapperDrive, MapsFarFewerFalseStepsWhereItsMapKnowsTheKerbs) {
  const World world = yard();
  const HeightMap map = map_of(world);
  const Way over_both{{9.0, 1.0}, {15.0, -1.5}, {8.5, 2.0}, {1.0, -1.0}};
  Drive drive(world, 1, {}, &map);
  drive.along(over_both);
  EXPECT_NEAR(drive.mapper().pose().z_m, drive.truth().z_m, 0.015);
  MapperConfig by_instruments;
  by_instruments.ground_tracking.reach_m = 0.0;
  Drive alone(world, 1, by_instruments, &map);
  alone.along(over_both);
  const int steps = false_steps(drive.mapper(), map);
  EXPECT_LT(2 * steps, false_steps(alone.mapper(), map)) << steps;
}

TEST(MapperDrive, TellsLittleOfARoomThatItWasGiven) {
  const auto told = [](Drive& drive) {
    drive.along(kLap);
    drive.mapper().finish();
    int cells = 0;
    for (const auto& [sequence, submap] : proto::testing::delivered(drive.evidence(), 125)) {
      for (const auto& [key, tile] : submap.surface.tiles()) cells += tile->known_count();
      for (const auto& [key, tile] : submap.seen_through.tiles()) cells += tile->known_count();
    }
    return cells;
  };
  const HeightMap room = map_of_room(6);
  Drive alone("room", 6, {});
  Drive given("room", 6, {}, &room);
  EXPECT_LT(told(given), told(alone) / 2);
  EXPECT_LT(given.error_m(), 0.06);
}

TEST(MapperDrive, IsLostAndWritesNothingUntilItHasFoundItselfInTheMap) {
  const HeightMap room = map_of_room(5);
  MapperConfig unknown;
  unknown.start_known = false;
  Drive drive("room", 5, unknown, &room, {.x_m = 3.0, .y_m = 2.0, .yaw_rad = 1.0});
  EXPECT_EQ(drive.mapper().localization(), LocalizationState::lost);
  drive.stand(20);
  EXPECT_EQ(drive.mapper().open_submap(), nullptr);
  EXPECT_EQ(drive.evidence().submaps(), 0U);
  drive.along(kLap);
  EXPECT_EQ(drive.mapper().localization(), LocalizationState::localized)
      << drive.mapper().localization_why();
  EXPECT_LT(drive.error_m(), 0.1);
  EXPECT_NE(drive.mapper().open_submap(), nullptr);
}

TEST(MapperDrive, NoticesThatItIsNotWhereItWasToldAndFindsItself) {
  const HeightMap room = map_of_room(6);
  Drive drive("room", 6, {}, &room, {.x_m = 4.5, .y_m = 5.0, .yaw_rad = 1.5});
  bool lost = false;
  for (const Eigen::Vector2d& corner : kLap) {
    for (double share = 0.1; share <= 1.0; share += 0.1) {
      const Eigen::Vector2d here(drive.truth().x_m, drive.truth().y_m);
      drive.along({here + share * (corner - here)});
      lost = lost || drive.mapper().localization() == LocalizationState::lost;
    }
  }
  drive.along(kLap);
  EXPECT_TRUE(lost);
  EXPECT_EQ(drive.mapper().localization(), LocalizationState::localized)
      << drive.mapper().localization_why();
  EXPECT_LT(drive.error_m(), 0.1);
}

}  // namespace
}  // namespace cairn::agent
