#include "robot_agent/input/passers_by.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace cairn::agent {
namespace {

constexpr double kStepS = 0.1;
const Eigen::Vector3d kEast = Eigen::Vector3d::UnitX();

/// [m] How far east of the origin somebody stands in the line of sight.
double distance_m(const PassersBy& people) { return people.range_m({0, 0, 1}, kEast, 50.0); }

TEST(PassersBy, WalkToAndFro) {
  PassersBy people({{.from_m = {10, 0}, .to_m = {14, 0}, .speed_m_s = 1.0}});
  const Pose far_away{.x_m = -100.0};
  EXPECT_NEAR(distance_m(people), 9.75, 1e-9);
  for (int i = 0; i < 30; ++i) people.step(kStepS, far_away);
  EXPECT_NEAR(distance_m(people), 12.75, 1e-6);
  for (int i = 0; i < 30; ++i) people.step(kStepS, far_away);
  EXPECT_LT(distance_m(people), 13.0) << "on the way back";
}

TEST(PassersBy, StopShortOfTheRobotAndTurnRoundWhenItStays) {
  PassersBy people({{.from_m = {10, 0}, .to_m = {0, 0}, .speed_m_s = 1.0}});
  const Pose robot{.x_m = 2.0};
  double nearest_m = 50.0;
  for (int i = 0; i < 160; ++i) {
    people.step(kStepS, robot);
    EXPECT_FALSE(people.touched_by(robot, 0.8, 0.6));
    nearest_m = std::min(nearest_m, distance_m(people));
  }
  EXPECT_NEAR(nearest_m, 2.0 + PassersBy::kRoomM - 0.25, 0.15);
  EXPECT_GT(distance_m(people), 5.0) << "waited, and went back";
}

TEST(PassersBy, AreSeenUpToTheirHeight) {
  const PassersBy people({{.from_m = {5, 0}, .to_m = {5, 0}, .speed_m_s = 0.0, .top_m = 1.8}});
  EXPECT_NEAR(people.range_m({0, 0, 1.7}, kEast, 50.0), 4.75, 1e-9);
  EXPECT_EQ(people.range_m({0, 0, 1.9}, kEast, 50.0), 50.0);
  EXPECT_EQ(people.range_m({0, 1, 1.0}, kEast, 50.0), 50.0);
}

TEST(PassersBy, AreTouchedByARobotThatDrivesIntoThem) {
  const PassersBy people({{.from_m = {5, 0}, .to_m = {5, 0}, .speed_m_s = 0.0}});
  EXPECT_TRUE(people.touched_by({.x_m = 4.5}, 0.8, 0.6));
  EXPECT_FALSE(people.touched_by({.x_m = 4.2}, 0.8, 0.6));
}

}  // namespace
}  // namespace cairn::agent
