// A world that changes while robots map it (T4.3): what was taken away is unlearned, what was put
// there is learned, and who only walks by leaves nothing behind. Everything goes the whole way:
// beams, submaps with what was seen through, folds into the long-term map.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/map/fold.h"
#include "core/map/update.h"
#include "core/sensor/laser.h"

namespace cairn {
namespace {

constexpr int kCellMm = 125;
constexpr double kSeeM = 15.0;

/// Stands on level ground at z = 0.
struct Box {
  double west_m, south_m, east_m, north_m, height_m;

  /// Range at which a ray meets it; infinite when it does not.
  [[nodiscard]] double range_m(const Eigen::Vector3d& from, const Eigen::Vector3d& along) const {
    double enter = 0.0;
    double leave = std::numeric_limits<double>::infinity();
    const Eigen::Vector3d low(west_m, south_m, 0.0);
    const Eigen::Vector3d high(east_m, north_m, height_m);
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (low[axis] - from[axis]) / along[axis];
      const double b = (high[axis] - from[axis]) / along[axis];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave ? enter : std::numeric_limits<double>::infinity();
  }
};

using Scene = std::vector<Box>;
/// What stands there at a time [s].
using ChangingScene = std::function<Scene(double)>;

const Box kHouse{6.0, -8.0, 7.0, 8.0, 3.0};  // So that beams end somewhere.
const Box kCrate{2.5, -0.5, 3.5, 0.5, 0.8};

/// A person on the way from (3, -5) to (3, 5) at 1 m/s.
Box person_at(double time_s) {
  const double y_m = -5.0 + time_s;
  return {2.8, y_m - 0.2, 3.2, y_m + 0.2, 1.7};
}
Scene with_passer_by(double time_s) { return {kHouse, person_at(time_s)}; }

double range_m(const Scene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& along) {
  double range = along.z() < 0.0 ? -from.z() / along.z() : 1e9;
  for (const Box& box : scene) range = std::min(range, box.range_m(from, along));
  return range;
}

/// A robot that maps with two lasers at 5 Hz, knows where it is, and folds its submaps into the
/// long-term map, against which it also notes what it sees through (as the agent does).
class Robot {
 public:
  explicit Robot(std::uint64_t seed) : random_(seed) {}

  /// One submap on the way from `from` to `to`, 0.5 m/s or `seconds` where it stands.
  void map_along(const ChangingScene& scene, const Pose& from, const Pose& to, double seconds) {
    Submap submap({1, ++count_}, {}, kCellMm);
    const int scans = static_cast<int>(seconds * 5.0);
    for (int i = 0; i < scans; ++i) {
      const double part = static_cast<double>(i) / scans;
      const Pose robot{std::lerp(from.x_m, to.x_m, part),
                       std::lerp(from.y_m, to.y_m, part),
                       0.0,
                       0.0,
                       0.0,
                       from.yaw_rad};
      for (const LaserSpec& laser : atrv_jr_lasers()) {
        look(submap, scene(time_s_), robot, laser);
      }
      time_s_ += 0.2;
    }
    fold(long_term_, submap, model_);
  }

  void stand(const ChangingScene& scene, const Pose& at, double seconds) {
    map_along(scene, at, at, seconds);
  }

  [[nodiscard]] const HeightMap& long_term() const { return long_term_; }
  [[nodiscard]] double time_s() const { return time_s_; }

 private:
  void look(Submap& submap, const Scene& scene, const Pose& robot, const LaserSpec& laser) {
    std::normal_distribution<double> range_error(0.0, 0.015);
    std::normal_distribution<double> tilt_error(0.0, 0.003);
    Scan scan;
    const Eigen::Isometry3d T = to_transform(robot) * to_transform(laser.T_robot_sensor);
    for (int i = 0; i < laser.beam_count; ++i) {
      const double angle = laser.first_angle_rad + i * laser.step_rad;
      const Eigen::Vector3d along =
          T.linear() * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
      const double range = range_m(scene, T.translation(), along);
      scan.range_m.push_back(static_cast<float>(range + range_error(random_)));
    }
    Pose believed = robot;
    believed.roll_rad = tilt_error(random_);
    believed.pitch_rad = tilt_error(random_);
    const ScanEffect effect = integrator_.integrate(
        submap.surface, beams_in_site(scan, laser, believed, kSeeM), std::nullopt, &long_term_);
    note(submap, effect.contradictions);
  }

  void note(Submap& submap, const std::vector<Contradiction>& contradictions) const {
    for (const Contradiction& contradiction : contradictions) {
      const auto emptiness = static_cast<std::uint8_t>(
          255 - (contradiction.grazing ? model_.graze_probability : model_.miss_probability));
      const Cell before = submap.seen_through.cell(contradiction.cell);
      Cell after{contradiction.height_mm, emptiness};
      if (before.known()) {
        after.height_mm = std::min(before.height_mm, contradiction.height_mm);
        after.probability =
            std::min(combine(before.probability, emptiness), model_.max_probability);
      }
      submap.seen_through.set(contradiction.cell, after);
    }
  }

  SensorModel model_;
  ScanIntegrator integrator_{model_};
  HeightMap long_term_{kCellMm};
  std::mt19937_64 random_;
  std::uint32_t count_ = 0;
  double time_s_ = 0.0;
};

/// Cells in a rectangle that the map holds to stand higher than a step.
int standing_cells(const HeightMap& map, double west_m, double south_m, double east_m,
                   double north_m) {
  int count = 0;
  const CellIndex low = map.cell_at(west_m, south_m);
  const CellIndex high = map.cell_at(east_m, north_m);
  for (std::int32_t y = low.y; y <= high.y; ++y) {
    for (std::int32_t x = low.x; x <= high.x; ++x) {
      const Cell cell = map.cell({x, y});
      count += cell.known() && cell.height_mm > 150 ? 1 : 0;
    }
  }
  return count;
}
int standing_in_the_open(const HeightMap& map) { return standing_cells(map, -6.0, -7.5, 5.7, 7.5); }

const Pose kWest{-2.0, 0.0, 0.0, 0.0, 0.0, 0.0};
const Pose kEast{4.0, 0.0, 0.0, 0.0, 0.0, 0.0};

/// Back and forth over the open, so that the inclined laser sweeps it; a submap for each way.
void patrol(Robot& robot, const ChangingScene& scene, int ways) {
  for (int way = 0; way < ways; ++way) robot.map_along(scene, kWest, kEast, 12.0);
}

ChangingScene always(const Scene& scene) {
  return [scene](double) { return scene; };
}

TEST(ChangingWorld, whatIsPutThereIsLearnedFromOneSubmap) {
  Robot robot(1);
  patrol(robot, always({kHouse}), 3);
  EXPECT_EQ(standing_in_the_open(robot.long_term()), 0);
  robot.map_along(always({kHouse, kCrate}), kWest, {1.0, 0.0}, 6.0);
  EXPECT_GE(standing_cells(robot.long_term(), 2.3, -0.6, 2.7, 0.6), 7);  // Its face is 1 m wide.
}

TEST(ChangingWorld, whatIsTakenAwayIsUnlearnedWithinAFewSubmaps) {
  Robot robot(2);
  for (int way = 0; way < 4; ++way) {
    robot.map_along(always({kHouse, kCrate}), kWest, {1.0, 0.0}, 6.0);
  }
  ASSERT_GE(standing_in_the_open(robot.long_term()), 7);
  patrol(robot, always({kHouse}), 4);
  EXPECT_EQ(standing_in_the_open(robot.long_term()), 0);
}

TEST(ChangingWorld, whatStaysIsKeptByTheSamePatrols) {
  Robot robot(3);
  patrol(robot, always({kHouse}), 2);
  const int before = standing_cells(robot.long_term(), 5.8, -6.0, 6.3, 6.0);
  EXPECT_GT(before, 80);  // 12 m of its face.
  patrol(robot, always({kHouse}), 6);
  EXPECT_GE(standing_cells(robot.long_term(), 5.8, -6.0, 6.3, 6.0), before);
}

TEST(ChangingWorld, aPersonWhoWalksByARobotOnPatrolLeavesNothing) {
  Robot robot(4);
  const auto from_now = [](double time_s) { return with_passer_by(time_s - 12.0); };
  patrol(robot, always({kHouse}), 1);
  robot.map_along(from_now, kWest, {0.0, 0.0}, 10.0);
  patrol(robot, always({kHouse}), 2);
  EXPECT_EQ(standing_in_the_open(robot.long_term()), 0);
}

/// Level beams pass at the height at which they met the person: each says little against them, but
/// all do, and the robot need not drive there.
TEST(ChangingWorld, aPersonWhoStoodInViewIsUnlearnedByARobotThatStaysWhereItIs) {
  Robot robot(7);
  const Box person{1.3, -0.2, 1.7, 0.2, 1.7};
  robot.stand(always({kHouse, person}), kWest, 20.0);
  ASSERT_GT(standing_in_the_open(robot.long_term()), 0);
  robot.stand(always({kHouse}), kWest, 30.0);
  robot.stand(always({kHouse}), kWest, 30.0);
  EXPECT_EQ(standing_in_the_open(robot.long_term()), 0);
}

TEST(ChangingWorld, aWallSeenAlongItsFaceIsNotGrazedAway) {
  Robot robot(8);
  const Box wall{-6.0, 1.0, 5.0, 1.3, 3.0};
  const Pose beside{-5.0, 0.6, 0.0, 0.0, 0.0, 0.0};
  robot.stand(always({kHouse, wall}), beside, 10.0);
  const int before = standing_cells(robot.long_term(), -4.0, 0.9, 2.0, 1.2);
  ASSERT_GE(before, 35);  // 6 m of it are 48 cells.
  for (int i = 0; i < 3; ++i) robot.stand(always({kHouse, wall}), beside, 20.0);
  EXPECT_GE(standing_cells(robot.long_term(), -4.0, 0.9, 2.0, 1.2), before);
}

TEST(ChangingWorld, aPersonSeenByAStandingRobotIsUnlearnedOnceItDrivesThere) {
  Robot robot(5);
  robot.stand(with_passer_by, kWest, 30.0);
  patrol(robot, always({kHouse}), 3);
  EXPECT_EQ(standing_in_the_open(robot.long_term()), 0);
}

TEST(ChangingWorld, aPersonAtTheEndOfASubmapIsUnlearnedByLaterOnes) {
  Robot robot(6);
  patrol(robot, always({kHouse}), 1);
  const double until_the_person_is_in_view = 3.0;
  const double begun_s = robot.time_s();
  const auto from_now = [&](double time_s) { return with_passer_by(time_s - begun_s); };
  robot.map_along(from_now, kWest, {0.0, 0.0}, until_the_person_is_in_view);
  ASSERT_GT(standing_in_the_open(robot.long_term()), 0);
  patrol(robot, always({kHouse}), 3);
  EXPECT_EQ(standing_in_the_open(robot.long_term()), 0);
}

}  // namespace
}  // namespace cairn
