// How the driver uses the field that came with its order.

#include <set>

#include "tests/unit/robot_agent/drive/field_fixture.h"

namespace cairn::agent {
namespace {

using testing::corridor_of;
using ::testing::ElementsAre;

/// A wall across the way, from x 3 to 3.5 m, that the map did not know. The robot sees no further
/// than 6 m and not through the wall.
class FieldTest : public DriverTest {
 protected:
  static constexpr double kWallM = 3.0;
  static constexpr double kWallThickM = 0.5;
  double wall_low_m = -1.2;
  double wall_high_m = 1.2;
  std::set<std::pair<int, int>> seen;

  FieldTest() {
    cells = [this](CellIndex cell) {
      if (!seen.contains({cell.x, cell.y})) return Cell{};
      return Cell{on_wall({(cell.x + 0.5) * kCellM, (cell.y + 0.5) * kCellM}) ? 1000 : 0, 200};
    };
  }
  [[nodiscard]] bool on_wall(const Eigen::Vector2d& p_m) const {
    return p_m.x() >= kWallM && p_m.x() < kWallM + kWallThickM && p_m.y() >= wall_low_m &&
           p_m.y() < wall_high_m;
  }
  void look() {
    constexpr double kSightM = 6.0;
    constexpr double kStepM = 0.06;
    for (int beam = 0; beam < 720; ++beam) {
      const Eigen::Vector2d way(std::cos(beam * M_PI / 360), std::sin(beam * M_PI / 360));
      for (double far_m = 0.0; far_m < kSightM; far_m += kStepM) {
        const Eigen::Vector2d p_m = testing::place_of(pose) + far_m * way;
        const CellIndex cell = testing::cell_at(p_m);
        seen.insert({cell.x, cell.y});
        if (on_wall(p_m)) break;
      }
    }
  }
  void drive_for(Duration time) {
    int steps = 0;
    for (const MonotonicTime end = clock + time; clock < end; ++steps) {
      if (steps % 10 == 0) look();
      step();
      ASSERT_FALSE(on_wall(testing::place_of(pose)));
      if (auto asked = driver.take_request()) requests.push_back(*asked);
    }
  }
  std::vector<proto::CorridorRequest> requests;
};

TEST_F(FieldTest, PicksTheFieldUpBesideAWallThatHidesThePathBehindIt) {
  const auto order = go_to(7, {{0, 0}, {10, 0}});
  take(order);
  driver.take(corridor_of(order, 24), kCellMm);
  drive_for(seconds(60));
  EXPECT_THAT(states(), ElementsAre(CommandState::accepted, CommandState::arrived));
  EXPECT_NEAR(pose.x_m, 10.0, 0.1);
}

TEST_F(FieldTest, WithoutACorridorItWaitsThereForTheServer) {
  take(go_to(7, {{0, 0}, {10, 0}}));
  drive_for(seconds(10));
  EXPECT_EQ(reports.back().state, CommandState::blocked);
}

TEST_F(FieldTest, AsksForAWiderCorridorWhereItFindsNoWayAroundAndUsesIt) {
  wall_high_m = 2.2;
  wall_low_m = -20.0;
  const auto order = go_to(7, {{0, 0}, {10, 0}});
  take(order);
  driver.take(corridor_of(order, 6), kCellMm);
  drive_for(seconds(8));
  ASSERT_EQ(reports.back().state, CommandState::blocked);
  ASSERT_FALSE(requests.empty());
  EXPECT_EQ(requests.back().command, 7U);
  EXPECT_EQ(requests.back().revision, 1U);
  EXPECT_EQ(requests.back().wish, proto::CorridorWish::corridor);
  EXPECT_GE(requests.back().half_width, 24);
  EXPECT_NEAR(requests.back().x_mm, pose.x_m * 1000, 100);
  driver.take(corridor_of(order, requests.back().half_width), kCellMm);
  drive_for(seconds(60));
  EXPECT_EQ(reports.back().state, CommandState::arrived);
}

TEST_F(FieldTest, AsksForMoreWhereTheCorridorAheadEnds) {
  wall_low_m = wall_high_m = 0.0;
  const auto order = go_to(7, {{0, 0}, {4, 0}, {20, 0}});
  take(order);
  proto::CorridorPart beginning = corridor_of(go_to(7, {{0, 0}, {4, 0}}), 12, {20, 0});
  driver.take(beginning, kCellMm);
  drive_for(seconds(12));
  ASSERT_GE(requests.size(), 2U);
  EXPECT_LE(requests.size(), 3U) << "every 5 s at most";
  EXPECT_GT(requests[0].x_mm, 4'000);
  EXPECT_EQ(requests[0].wish, proto::CorridorWish::corridor);
}

TEST_F(FieldTest, AsksForNothingBeforeItsFirstCorridor) {
  wall_low_m = wall_high_m = 0.0;
  take(go_to(7, {{0, 0}, {20, 0}}));
  drive_for(seconds(12));
  EXPECT_TRUE(requests.empty());
}

TEST_F(FieldTest, AsksForANewPlanWhileItDrivesAgainstTheField) {
  wall_low_m = wall_high_m = 0.0;
  const auto order = go_to(7, {{0, 0}, {20, 0}});
  take(order);
  driver.take(corridor_of(order, 12, {-20, 0}), kCellMm);
  drive_for(seconds(12));
  ASSERT_EQ(requests.size(), 1U) << "every 15 s at most";
  EXPECT_EQ(requests[0].wish, proto::CorridorWish::plan);
  EXPECT_GT(pose.x_m, 2.0) << "it drives on meanwhile";
  EXPECT_LT(requests[0].x_mm, 1'000);
}

TEST_F(FieldTest, ANewPathForgetsTheOldCorridor) {
  const auto order = go_to(7, {{0, 0}, {10, 0}});
  take(order);
  driver.take(corridor_of(order, 24), kCellMm);
  take(go_to(7, {{0, 0}, {10, 0}}, 2));
  driver.take(corridor_of(order, 24), kCellMm);
  drive_for(seconds(10));
  EXPECT_EQ(reports.back().state, CommandState::blocked) << "no corridor is of this path";
}

TEST_F(FieldTest, APathThatCannotBeReadIsRefused) {
  auto order = go_to(7, {{0, 0}, {10, 0}});
  order.path.pop_back();
  take(order);
  EXPECT_THAT(states(), ElementsAre(CommandState::refused));
}

}  // namespace
}  // namespace cairn::agent
