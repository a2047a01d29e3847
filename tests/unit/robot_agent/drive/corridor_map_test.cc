#include "robot_agent/drive/corridor_map.h"

#include "tests/unit/robot_agent/drive/field_fixture.h"

namespace cairn::agent {
namespace {

using testing::cell_at;
using testing::corridor_of;
using testing::corridor_to;

constexpr std::uint8_t kEast = 0;

class CorridorMapTest : public ::testing::Test {
 protected:
  proto::RobotLink::Order order = go_to(7, {{0, 0.06}, {4, 0.06}, {8, 0.06}, {8, 6}});
  CorridorMap map{order.command, read_path(order.command, order.path).value()};
};

TEST_F(CorridorMapTest, TellsTheFieldsDirections) {
  EXPECT_TRUE(map.empty());
  EXPECT_EQ(map.direction(cell_at({1, 0})), Corridor::outside);
  ASSERT_TRUE(map.take(corridor_of(order, 8, {20.06, 0.06}), kCellMm));
  EXPECT_EQ(map.direction(cell_at({1, 0})), kEast);
  EXPECT_EQ(map.direction(cell_at({1, 3})), Corridor::outside);
}

TEST_F(CorridorMapTest, TakesOnlyWhatIsOfItsOrder) {
  proto::CorridorPart part = corridor_of(order, 8);
  part.revision = 2;
  EXPECT_EQ(map.take(part, kCellMm).error().code, ErrorCode::conflict);
  part.revision = 1;
  part.command = 8;
  EXPECT_FALSE(map.take(part, kCellMm));
  EXPECT_TRUE(map.empty());
}

TEST_F(CorridorMapTest, RefusesWhatItCannotRead) {
  const proto::CorridorPart good = corridor_of(order, 8);
  EXPECT_FALSE(map.take(good, 250)) << "cells of another size";
  proto::CorridorPart part = good;
  part.first = 3;
  EXPECT_FALSE(map.take(part, kCellMm)) << "more points than the path has";
  part = good;
  part.directions.resize(part.directions.size() + 40, 0xFF);
  EXPECT_FALSE(map.take(part, kCellMm)) << "directions too many";
  part = good;
  part.spine = {0xFF, 0xFF};
  EXPECT_FALSE(map.take(part, kCellMm)) << "no path";
  part.spine = {0x7D, 0x00};
  EXPECT_FALSE(map.take(part, kCellMm)) << "a path of no points";
  EXPECT_TRUE(map.empty());
  EXPECT_TRUE(map.take(good, kCellMm));
}

TEST_F(CorridorMapTest, OfTwoMapsTheNewerCounts) {
  proto::CorridorPart newer = corridor_of(order, 8, {-20, 0});
  newer.map_version = 9;
  ASSERT_TRUE(map.take(newer, kCellMm));
  ASSERT_TRUE(map.take(corridor_of(order, 8), kCellMm));
  EXPECT_EQ(map.direction(cell_at({1, 0})), 4) << "west";
}

TEST_F(CorridorMapTest, HoldsABoundedNumber) {
  proto::CorridorPart part = corridor_of(order, 1, {20, 0});
  for (std::uint64_t version = 1; version <= 3 * CorridorMap::kMaxParts; ++version) {
    part.map_version = version;
    ASSERT_TRUE(map.take(part, kCellMm));
  }
  proto::CorridorPart oldest = corridor_of(order, 8, {20, 0});
  oldest.map_version = 0;
  ASSERT_TRUE(map.take(oldest, kCellMm));
  EXPECT_EQ(map.direction(cell_at({1, 0.8})), Corridor::outside) << "nothing of the oldest is kept";
}

TEST_F(CorridorMapTest, AtACorridorsEndThePathGoesOn) {
  const CodedPath path = decode_path(order.path).value();
  proto::CorridorPart part = corridor_of(order, 8);
  part.count = 2;
  part.directions = corridor_to({8, 6}, {kCellMm, {path.points[0], path.points[1]}}, 8).encode();
  ASSERT_TRUE(map.take(part, kCellMm));
  const auto rest = map.rest_from(cell_at({4.5, 0.5}));
  ASSERT_TRUE(rest);
  EXPECT_TRUE(rest->to_goal);
  ASSERT_EQ(rest->points_m.size(), 3U);
  EXPECT_NEAR(rest->points_m[0].x(), 4.5, 0.1);
  EXPECT_EQ(rest->points_m.back(), Eigen::Vector2d(8, 6));
  EXPECT_FALSE(map.rest_from(cell_at({1, 0.9}))) << "that is its side";
}

TEST_F(CorridorMapTest, APathOfItsOwnMayEndShortOfTheGoal) {
  const CodedPath own = quantise({{0, 5}, {4, 5}}, kCellMm).value();
  proto::CorridorPart part = corridor_of(order, 8);
  part.spine = encode_path(own);
  part.count = 2;
  part.directions = corridor_to({8, 6}, own, 8).encode();
  ASSERT_TRUE(map.take(part, kCellMm));
  const auto rest = map.rest_from(cell_at({4.5, 5.2}));
  ASSERT_TRUE(rest);
  EXPECT_FALSE(rest->to_goal);
  EXPECT_NEAR(rest->points_m.back().x(), 4.0, 0.02);
}

TEST(ReadPath, EndsAtTheExactGoal) {
  const auto order = go_to(7, {{0, 0}, {4.013, 2.009}});
  EXPECT_EQ(read_path(order.command, order.path)->points_m.back(), Eigen::Vector2d(4.013, 2.009));
}

TEST(ReadPath, LeavesAnEndElsewhereWhereItIs) {
  auto order = go_to(7, {{0, 0}, {4, 2}});
  order.command.goal_x_mm = 9'000;
  EXPECT_NEAR(read_path(order.command, order.path)->points_m.back().x(), 4.0, 0.02);
  EXPECT_FALSE(read_path(order.command, {0x7D, 0x00}));
  EXPECT_FALSE(read_path(order.command, {0x7D, 0x02, 0x80}));
}

}  // namespace
}  // namespace cairn::agent
