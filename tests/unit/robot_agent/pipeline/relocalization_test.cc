#include "robot_agent/pipeline/relocalization.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/common/angle.h"
#include "core/map/update.h"
#include "robot_agent/pipeline/submap_frame.h"
#include "tests/unit/robot_agent/pipeline/scene.h"

namespace cairn::agent {
namespace {

using testing::box;
using testing::Scene;

constexpr double kRangeM = 12.0;

/// A yard with a wall around it, in which no two corners look the same.
Scene yard() {
  return {{box(-9, 9, 7, 7.5, 2), box(-9, 9, -7.5, -7, 2), box(9, 9.5, -7.5, 7.5, 2),
           box(-9.5, -9, -7.5, 7.5, 2), box(-6, -4, 2, 3.5, 1.2), box(3, 3.6, -5, -2, 1.5),
           box(5, 7.5, 4, 5, 0.9), box(-3, -2.2, -6, -4, 1.1), box(0.5, 1.2, 4.5, 7, 1.4)}};
}

/// The same wall around other things.
Scene other_yard() {
  return {{box(-9, 9, 7, 7.5, 2), box(-9, 9, -7.5, -7, 2), box(9, 9.5, -7.5, 7.5, 2),
           box(-9.5, -9, -7.5, 7.5, 2), box(-1, 3, -1, 0.5, 1.2), box(-7, -6.4, -3, 4, 1.5),
           box(4, 5, -6, -3, 0.9)}};
}

void look(const Scene& scene, const Pose& truth, const Pose& believed, HeightMap& map) {
  ScanIntegrator integrator{SensorModel{}};
  const std::vector<LaserSpec> lasers = atrv_jr_lasers();
  for (std::size_t i = 0; i < lasers.size(); ++i) {
    const Scan scan = scene.scan(lasers[i], i, truth, {});
    integrator.integrate(map, beams_in_site(scan, lasers[i], believed, kRangeM), std::nullopt,
                         nullptr);
  }
}

/// As robots have mapped it that knew where they were.
HeightMap map_of(const Scene& scene) {
  HeightMap map(MapperConfig{}.cell_size_mm);
  for (double y_m = -6.0; y_m <= 6.0; y_m += 1.0) {
    for (double x_m = -8.0; x_m <= 8.0; x_m += 1.0) {
      for (const double yaw_deg : {0, 60, 120, 180, 240, 300}) {
        const Pose pose{x_m, y_m, 0.0, 0.0, 0.0, wrap_angle(radians(yaw_deg))};
        look(scene, pose, pose, map);
      }
    }
  }
  return map;
}

/// A robot that does not know where it is. Its local frame lies somewhere in the site.
class Lost {
 public:
  explicit Lost(const Scene& scene) : scene_(scene) { relocalization_.begin(T_local_robot_); }

  /// Drives a circle of half a metre while it looks around; what each search said.
  std::vector<SiteMatch> circle(const HeightMap& site, int steps) {
    std::vector<SiteMatch> said;
    for (int i = 0; i < steps; ++i) {
      T_local_robot_.yaw_rad = wrap_angle(T_local_robot_.yaw_rad + 0.1);
      T_local_robot_.x_m += 0.05 * std::cos(T_local_robot_.yaw_rad);
      T_local_robot_.y_m += 0.05 * std::sin(T_local_robot_.yaw_rad);
      relocalization_.move(T_local_robot_);
      for (std::size_t i_laser = 0; i_laser < lasers_.size(); ++i_laser) {
        relocalization_.take_scan(scene_.scan(lasers_[i_laser], i_laser, truth(), {}),
                                  lasers_[i_laser], kRangeM);
      }
      if (const auto match = relocalization_.find(site)) said.push_back(*match);
    }
    return said;
  }
  void carry_to(const Pose& T_site_local) { T_site_local_ = T_site_local; }
  [[nodiscard]] Pose truth() const { return compose(T_site_local_, T_local_robot_); }
  [[nodiscard]] const Relocalization& relocalization() const { return relocalization_; }

 private:
  Scene scene_;
  std::vector<LaserSpec> lasers_ = atrv_jr_lasers();
  Pose T_site_local_{2.0, 1.0, 0.0, 0.0, 0.0, 2.2};
  Pose T_local_robot_;
  Relocalization relocalization_{MapperConfig{}};
};

TEST(Relocalization, FindsTheRobotTwiceBeforeItSaysSo) {
  const HeightMap site = map_of(yard());
  Lost robot(yard());
  const auto said = robot.circle(site, 110);
  ASSERT_GE(said.size(), 2U);
  EXPECT_FALSE(said[0].accepted);
  EXPECT_EQ(said[0].why, "found a place that fits; looks once more to be sure");
  ASSERT_TRUE(said[1].accepted) << said[1].why;
}

TEST(Relocalization, SaysWhereItStands) {
  const HeightMap site = map_of(yard());
  Lost robot(yard());
  for (int i = 0; i < 300; ++i) {
    const auto said = robot.circle(site, 1);
    if (said.empty() || !said.back().accepted) continue;
    EXPECT_NEAR(said.back().T_site_robot.x_m, robot.truth().x_m, 0.1);
    EXPECT_NEAR(said.back().T_site_robot.y_m, robot.truth().y_m, 0.1);
    EXPECT_NEAR(wrap_angle(said.back().T_site_robot.yaw_rad - robot.truth().yaw_rad), 0.0, 0.03);
    return;
  }
  FAIL() << "not found in " << robot.relocalization().searches() << " searches";
}

TEST(Relocalization, DoesNotBelieveTwoPlacesThatContradictEachOther) {
  const HeightMap site = map_of(yard());
  Lost robot(yard());
  std::vector<SiteMatch> said;
  while (said.empty() && robot.relocalization().searches() < 5) said = robot.circle(site, 1);
  ASSERT_EQ(said.size(), 1U);
  // Somebody carries it away before it could look once more.
  robot.carry_to({-6.0, -4.0, 0.0, 0.0, 0.0, -0.5});
  said.clear();
  while (said.empty()) said = robot.circle(site, 1);
  EXPECT_FALSE(said.front().accepted);
}

TEST(Relocalization, FindsNothingInTheMapOfAnotherPlace) {
  const HeightMap site = map_of(other_yard());
  Lost robot(yard());
  for (const SiteMatch& match : robot.circle(site, 300)) EXPECT_FALSE(match.accepted);
  EXPECT_GE(robot.relocalization().searches(), 4U);
}

TEST(Relocalization, DoesNotSearchBeforeItHasSeenEnoughNorInNothing) {
  Lost robot(yard());
  EXPECT_TRUE(robot.circle(map_of(yard()), 10).empty());
  EXPECT_TRUE(robot.circle(HeightMap(MapperConfig{}.cell_size_mm), 100).empty());
}

}  // namespace
}  // namespace cairn::agent
