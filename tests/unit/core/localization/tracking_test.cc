#include "core/localization/tracking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/common/angle.h"

namespace cairn {
namespace {

/// A room of 8 × 6 m with a pillar, and what a level laser reads in it.
class Room {
 public:
  explicit Room(double noise_m = 0.0) : noise_m_(noise_m) {
    laser.T_robot_sensor = {.x_m = 0.1, .z_m = 0.3};
  }

  LaserSpec laser;

  Scan scan(const Pose& T_room_robot) {
    const Eigen::Isometry3d T = to_transform(T_room_robot) * to_transform(laser.T_robot_sensor);
    Scan scan;
    for (int i = 0; i < laser.beam_count; ++i) {
      const double angle = laser.first_angle_rad + i * laser.step_rad;
      const Eigen::Vector3d along =
          T.linear() * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
      const double range_m = to_walls_m(T.translation(), along) + noise_m_ * normal_(dice_);
      scan.range_m.push_back(static_cast<float>(range_m));
    }
    return scan;
  }

 private:
  static void meet(double at, double from, double along, double other_from, double other_along,
                   double low, double high, double& range_m) {
    if (std::abs(along) < 1e-9) return;
    const double t = (at - from) / along;
    const double other = other_from + t * other_along;
    if (t > 0.0 && other >= low && other <= high) range_m = std::min(range_m, t);
  }
  static double to_walls_m(const Eigen::Vector3d& p, const Eigen::Vector3d& d) {
    double range_m = 100.0;
    for (const double x : {0.0, 8.0}) meet(x, p.x(), d.x(), p.y(), d.y(), 0.0, 6.0, range_m);
    for (const double y : {0.0, 6.0}) meet(y, p.y(), d.y(), p.x(), d.x(), 0.0, 8.0, range_m);
    for (const double x : {5.0, 5.5}) meet(x, p.x(), d.x(), p.y(), d.y(), 4.0, 4.5, range_m);
    for (const double y : {4.0, 4.5}) meet(y, p.y(), d.y(), p.x(), d.x(), 5.0, 5.5, range_m);
    return range_m;
  }

  double noise_m_;
  std::mt19937 dice_{7};
  std::normal_distribution<double> normal_;
};

const Eigen::Matrix3d kVague = Eigen::Vector3d(0.04, 0.04, 0.02).asDiagonal();

Pose at(double x_m, double y_m, double yaw_rad) {
  return {.x_m = x_m, .y_m = y_m, .yaw_rad = yaw_rad};
}

TEST(Tracking, MatchesNothingAtFirst) {
  Room room;
  Tracking tracking{{}};
  const TrackedStep step = tracking.track(room.scan(at(2, 2, 0)), room.laser, at(2, 2, 0), kVague);
  EXPECT_FALSE(step.matched);
  EXPECT_EQ(step.T_local_robot.x_m, 2.0);
}

TEST(Tracking, UndoesWhatThePredictionIsOffBy) {
  Room room(0.01);
  Tracking tracking{{}};
  (void)tracking.track(room.scan(at(2, 2, 0.2)), room.laser, at(2, 2, 0.2), kVague);
  const TrackedStep step =
      tracking.track(room.scan(at(2.3, 2.1, 0.3)), room.laser, at(2.18, 2.2, 0.2), kVague);
  ASSERT_TRUE(step.matched);
  EXPECT_NEAR(step.T_local_robot.x_m, 2.3, 0.015);
  EXPECT_NEAR(step.T_local_robot.y_m, 2.1, 0.015);
  EXPECT_NEAR(step.T_local_robot.yaw_rad, 0.3, 0.004);
}

const Eigen::Matrix3d kSure = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();

TEST(Tracking, BelievesASurpriseWhenTheNextSweepSaysTheSame) {
  Room room(0.01);
  Tracking tracking{{}};
  (void)tracking.track(room.scan(at(2, 2, 0)), room.laser, at(2, 2, 0), kSure);
  const TrackedStep first =
      tracking.track(room.scan(at(2, 2, 0.15)), room.laser, at(2, 2, 0), kSure);
  EXPECT_FALSE(first.matched);
  EXPECT_TRUE(first.surprising);
  EXPECT_FALSE(first.kept);
  EXPECT_EQ(first.T_local_robot.yaw_rad, 0.0);
  const TrackedStep second =
      tracking.track(room.scan(at(2.05, 2, 0.15)), room.laser, at(2.05, 2, 0), kSure);
  ASSERT_TRUE(second.matched);
  EXPECT_NEAR(second.T_local_robot.yaw_rad, 0.15, 0.02);  // The prediction pulls.
}

TEST(Tracking, ForgetsASurpriseThatDoesNotComeBack) {
  Room room(0.01);
  Tracking tracking{{}};
  (void)tracking.track(room.scan(at(2, 2, 0)), room.laser, at(2, 2, 0), kSure);
  EXPECT_TRUE(tracking.track(room.scan(at(2, 2, 0.15)), room.laser, at(2, 2, 0), kSure).surprising);
  EXPECT_TRUE(tracking.track(room.scan(at(2, 2, 0)), room.laser, at(2, 2, 0), kSure).matched);
  EXPECT_TRUE(tracking.track(room.scan(at(2, 2, 0.15)), room.laser, at(2, 2, 0), kSure).surprising);
}

TEST(Tracking, DoesNotDriftOnAWayThroughTheRoom) {
  Room room(0.01);
  Tracking tracking{{}};
  Pose believed = at(2, 2, 0);
  Pose before = believed;
  for (int i = 0; i <= 200; ++i) {
    const double t = i * radians(1.8);
    const Pose truth = at(4 - 2 * std::cos(t), 2.5 + 1.2 * std::sin(t), t);
    // Wheels that turn 10 % too little, and slip.
    believed.x_m += 0.9 * (truth.x_m - before.x_m);
    believed.y_m += 0.9 * (truth.y_m - before.y_m);
    believed.yaw_rad += 0.9 * wrap_angle(truth.yaw_rad - before.yaw_rad);
    if (i == 0) believed = truth;
    believed = tracking.track(room.scan(truth), room.laser, believed, kVague).T_local_robot;
    before = truth;
  }
  EXPECT_NEAR(believed.x_m, before.x_m, 0.03);
  EXPECT_NEAR(believed.y_m, before.y_m, 0.03);
  EXPECT_NEAR(wrap_angle(believed.yaw_rad - before.yaw_rad), 0.0, 0.01);
}

TEST(Tracking, FindsAHeadingThatIsFarOff) {
  Room room(0.01);
  Tracking tracking{{}};
  (void)tracking.track(room.scan(at(3, 2, 0)), room.laser, at(3, 2, 0), kVague);
  const TrackedStep step =
      tracking.track(room.scan(at(3, 2, 0.35)), room.laser, at(3, 2, 0), kVague);
  ASSERT_TRUE(step.matched);
  EXPECT_NEAR(step.T_local_robot.yaw_rad, 0.35, 0.01);
}

TEST(Tracking, KeepsThePredictionAlongACorridor) {
  Room room;
  room.laser.max_range_m = 2.5;  // Its ends are out of sight, and so is the pillar.
  Tracking tracking{{}};
  (void)tracking.track(room.scan(at(3, 1, 0)), room.laser, at(3, 1, 0), kVague);
  const TrackedStep step =
      tracking.track(room.scan(at(3.4, 1, 0)), room.laser, at(3.3, 1.1, 0), kVague);
  ASSERT_TRUE(step.matched);
  EXPECT_NEAR(step.T_local_robot.x_m, 3.3, 0.02);  // Nothing tells it.
  EXPECT_NEAR(step.T_local_robot.y_m, 1.0, 0.01);
  EXPECT_LT(step.information(0, 0), 0.01 * step.information(1, 1));
}

TEST(Tracking, LeavesThePredictionAloneWhereNothingFits) {
  Room room;
  Tracking tracking{{}};
  (void)tracking.track(room.scan(at(2, 2, 0)), room.laser, at(2, 2, 0), kVague);
  Scan noise = room.scan(at(2, 2, 0));
  std::mt19937 dice(3);
  for (float& range_m : noise.range_m) {
    range_m = std::uniform_real_distribution<float>(0.5F, 6.0F)(dice);
  }
  EXPECT_FALSE(tracking.track(noise, room.laser, at(2.1, 2, 0), kVague).matched);
}

TEST(Tracking, SurvivesWhatIsNoNumber) {
  Room room;
  Tracking tracking{{}};
  (void)tracking.track(room.scan(at(2, 2, 0)), room.laser, at(2, 2, 0), kVague);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Scan scan = room.scan(at(2, 2, 0));
  for (std::size_t i = 0; i < scan.range_m.size(); i += 2) scan.range_m[i] = nan;
  EXPECT_TRUE(is_finite(tracking.track(scan, room.laser, at(2, 2, 0), kVague).T_local_robot));
  Pose nowhere = at(2, 2, 0);
  nowhere.x_m = std::nan("");
  EXPECT_FALSE(tracking.track(room.scan(at(2, 2, 0)), room.laser, nowhere, kVague).matched);
  EXPECT_TRUE(tracking.track(room.scan(at(2, 2, 0)), room.laser, at(2, 2, 0), kVague).matched);
}

TEST(Tracking, ForgetsWhenTold) {
  Room room;
  Tracking tracking{{}};
  (void)tracking.track(room.scan(at(2, 2, 0)), room.laser, at(2, 2, 0), kVague);
  tracking.forget();
  EXPECT_FALSE(tracking.track(room.scan(at(2, 2, 0)), room.laser, at(2, 2, 0), kVague).matched);
}

}  // namespace
}  // namespace cairn
