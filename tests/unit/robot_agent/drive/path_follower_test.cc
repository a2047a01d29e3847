#include "robot_agent/drive/path_follower.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/robot_agent/drive/rolling_robot.h"

namespace cairn::agent {
namespace {

using testing::kStepS;
using testing::place_of;

constexpr double kArriveM = 0.06;
constexpr double kNoLimit = 100.0;

/// How a drive along a path went.
struct Drive {
  bool arrived = false;
  double seconds = 0.0;
  double widest_m = 0.0;  ///< Furthest off the path.
  double fastest_m_s = 0.0;
  double fastest_turn_rad_s = 0.0;
  bool reversed = false;
  double missed_m = 0.0;  ///< Largest of the distances at which it passed the path's points.
};

/// [m] How near the robot came to each point of the path.
class Passing {
 public:
  explicit Passing(const std::vector<Eigen::Vector2d>& path_m)
      : path_m_(path_m), nearest_m_(path_m.size(), 1e9) {}
  void at(const Eigen::Vector2d& place_m) {
    for (std::size_t i = 0; i < path_m_.size(); ++i) {
      nearest_m_[i] = std::min(nearest_m_[i], (path_m_[i] - place_m).norm());
    }
  }
  [[nodiscard]] double missed_m() const { return std::ranges::max(nearest_m_); }

 private:
  std::vector<Eigen::Vector2d> path_m_;
  std::vector<double> nearest_m_;
};

Drive drive(const FollowerConfig& config, const std::vector<Eigen::Vector2d>& path_m, Pose pose,
            double limit_m_s = kNoLimit, double patience_s = 120.0) {
  PathFollower follower(config, path_m);
  Drive drive;
  Passing passing(path_m);
  for (; drive.seconds < patience_s; drive.seconds += kStepS) {
    follower.advance(place_of(pose));
    passing.at(place_of(pose));
    drive.missed_m = passing.missed_m();
    drive.widest_m = std::max(drive.widest_m, follower.off_path_m());
    if ((path_m.back() - place_of(pose)).norm() <= kArriveM) {
      drive.arrived = true;
      return drive;
    }
    const DriveCommand wheels = follower.steer(pose, limit_m_s);
    drive.fastest_m_s = std::max(drive.fastest_m_s, wheels.speed_m_s);
    drive.fastest_turn_rad_s = std::max(drive.fastest_turn_rad_s, std::abs(wheels.turn_rate_rad_s));
    drive.reversed |= wheels.speed_m_s < 0.0;
    testing::roll(pose, wheels);
  }
  return drive;
}

struct Course {
  const char* name;
  std::vector<Eigen::Vector2d> path_m;
  Pose start;
};

class EveryCourse : public ::testing::TestWithParam<Course> {};

TEST_P(EveryCourse, EndsWithinSixCentimetresOfThePathsEnd) {
  EXPECT_TRUE(drive({}, GetParam().path_m, GetParam().start).arrived);
}

TEST_P(EveryCourse, KeepsTheLimitsOfSpeedAndTurn) {
  const FollowerConfig config;
  const Drive driven = drive(config, GetParam().path_m, GetParam().start);
  EXPECT_LE(driven.fastest_m_s, config.max_speed_m_s + 1e-9);
  EXPECT_LE(driven.fastest_turn_rad_s, config.max_turn_rad_s + 1e-9);
  EXPECT_FALSE(driven.reversed);
}

TEST_P(EveryCourse, StaysNearThePath) {
  EXPECT_LE(drive({}, GetParam().path_m, GetParam().start).widest_m, 0.3);
}

TEST_P(EveryCourse, PassesEveryPointOfThePath) {
  EXPECT_LE(drive({}, GetParam().path_m, GetParam().start).missed_m, 0.35);
}

INSTANTIATE_TEST_SUITE_P(
    PathFollower, EveryCourse,
    ::testing::Values(
        Course{"straight", {{0, 0}, {6, 0}}, {}},
        Course{"straight_from_the_side", {{0, 0}, {6, 0}}, {.y_m = 0.25}},
        Course{"straight_facing_backwards", {{0, 0}, {6, 0}}, {.yaw_rad = radians(180.0)}},
        Course{"bent", {{0, 0}, {3, 0}, {3, 3}, {6, 5}}, {}},
        Course{"many_small_legs", {{0, 0}, {0.1, 0}, {0.2, 0.02}, {0.3, 0.1}, {1, 1}, {1, 2}}, {}},
        Course{"u_turn", {{0, 0}, {4, 0}, {4, 1}, {0, 1}}, {}},
        Course{"narrow_u_turn", {{0, 0}, {4, 0}, {4, 0.3}, {0, 0.3}}, {}},
        Course{"there_and_back", {{0, 0}, {4, 0}, {-1, 0}}, {}},
        Course{"doubled_point", {{0, 0}, {2, 0}, {2, 0}, {4, 1}}, {}}),
    [](const auto& course) { return std::string(course.param.name); });

TEST(PathFollower, DrivesAnObliqueThereAndBackToTheTurningPoint) {
  const Eigen::Vector2d along(std::cos(0.7), std::sin(0.7));
  PathFollower follower({}, {{0, 0}, 4.0 * along, 1.0 * along});
  Pose pose{.yaw_rad = 0.7};
  double furthest_m = 0.0;
  for (int i = 0; i < 2000; ++i) {
    follower.advance(place_of(pose));
    furthest_m = std::max(furthest_m, place_of(pose).dot(along));
    testing::roll(pose, follower.steer(pose, kNoLimit));
  }
  EXPECT_GT(furthest_m, 3.5);
}

TEST(PathFollower, TurnsOnTheSpotTowardsWhatIsBehind) {
  PathFollower follower({}, {{0, 0}, {-3, 0}});
  follower.advance({0, 0});
  const DriveCommand wheels = follower.steer({.yaw_rad = radians(20.0)}, kNoLimit);
  EXPECT_EQ(wheels.speed_m_s, 0.0);
  EXPECT_GT(wheels.turn_rate_rad_s, 0.0);  // The shorter way round.
}

TEST(PathFollower, TurnsTheShorterWayRound) {
  PathFollower follower({}, {{0, 0}, {-3, 0}});
  follower.advance({0, 0});
  EXPECT_LT(follower.steer({.yaw_rad = radians(-20.0)}, kNoLimit).turn_rate_rad_s, 0.0);
}

TEST(PathFollower, NeverDrivesFasterThanItIsAllowed) {
  EXPECT_LE(drive({}, {{0, 0}, {3, 0}, {3, 2}}, {}, 0.2).fastest_m_s, 0.2);
}

TEST(PathFollower, StandsStillWhenNothingIsAllowed) {
  PathFollower follower({}, {{0, 0}, {3, 0}});
  follower.advance({0, 0});
  const DriveCommand wheels = follower.steer({}, 0.0);
  EXPECT_EQ(wheels.speed_m_s, 0.0);
  EXPECT_EQ(wheels.turn_rate_rad_s, 0.0);
}

TEST(PathFollower, BrakesBeforeTheEndNoHarderThanPlanned) {
  const FollowerConfig config;
  PathFollower follower(config, {{0, 0}, {5, 0}});
  for (double left_m = 2.0; left_m > 0.1; left_m -= 0.05) {
    follower.advance({5.0 - left_m, 0});
    const double speed_m_s = follower.steer({.x_m = 5.0 - left_m}, kNoLimit).speed_m_s;
    EXPECT_LE(speed_m_s * speed_m_s / (2.0 * left_m), config.deceleration_m_s2) << left_m;
  }
}

TEST(PathFollower, TellsTheWayLeftAlongThePath) {
  PathFollower follower({}, {{0, 0}, {3, 0}, {3, 4}});
  follower.advance({1, 0});
  EXPECT_NEAR(follower.to_go_m(), 6.0, 1e-9);
}

TEST(PathFollower, CountsTheWayBackToThePathAsWayLeft) {
  PathFollower follower({}, {{0, 0}, {3, 0}});
  follower.advance({1, 0.5});
  EXPECT_NEAR(follower.off_path_m(), 0.5, 1e-9);
  EXPECT_NEAR(follower.to_go_m(), 2.5, 1e-9);
}

TEST(PathFollower, NeverGoesBackAlongThePath) {
  PathFollower follower({}, {{0, 0}, {5, 0}});
  follower.advance({2, 0});
  follower.advance({1, 0});
  EXPECT_NEAR(follower.ahead().front().x(), 2.0, 1e-9);
}

TEST(PathFollower, DoesNotCutAPathShortThatComesNearItself) {
  PathFollower follower({}, {{0, 0}, {5, 0}, {5, 5}, {1, 5}, {1, 0.2}});
  follower.advance({1, 0.1});  // Half-way between the first leg and the end.
  EXPECT_GT(follower.to_go_m(), 10.0);
}

TEST(PathFollower, ShowsTheRestOfTheWayFromTheFootOn) {
  PathFollower follower({}, {{0, 0}, {3, 0}, {3, 4}});
  follower.advance({1, 0.2});
  const std::vector<Eigen::Vector2d> rest = follower.ahead();
  ASSERT_EQ(rest.size(), 3U);
  EXPECT_NEAR((rest[0] - Eigen::Vector2d(1, 0)).norm(), 0.0, 1e-9);
  EXPECT_EQ(rest[2], Eigen::Vector2d(3, 4));
}

TEST(PathFollower, TakesAPathOfOnePoint) { EXPECT_TRUE(drive({}, {{1, 1}}, {}).arrived); }

TEST(PathFollower, CutsNoCornerWhereThereIsHardlyRoom) {
  const std::vector<Eigen::Vector2d> corner{{0, 0}, {2, 0}, {2, 2}};
  PathFollower follower({}, corner);
  Pose pose;
  double widest_m = 0.0;
  double fastest_m_s = 0.0;
  for (int i = 0; i < 2000 && (corner.back() - place_of(pose)).norm() > kArriveM; ++i) {
    follower.advance(place_of(pose));
    const DriveCommand wheels = follower.steer_closely(pose, kNoLimit);
    fastest_m_s = std::max(fastest_m_s, wheels.speed_m_s);
    testing::roll(pose, wheels);
    widest_m = std::max(widest_m, follower.off_path_m());
  }
  EXPECT_LE((corner.back() - place_of(pose)).norm(), kArriveM);
  EXPECT_LT(widest_m, 0.5 * drive({}, corner, {}).widest_m);
  EXPECT_LE(fastest_m_s, FollowerConfig{}.close_speed_m_s);
}

}  // namespace
}  // namespace cairn::agent
