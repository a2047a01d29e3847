#include "server/mission/corridors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cairn::server {
namespace {

constexpr int kCellMm = 125;
constexpr double kCellM = 0.125;

/// 20 × 4 tiles of 8 m, level, with a post here and there.
MapSnapshot field_of_posts(unsigned seed) {
  std::mt19937 random(seed);
  MapSnapshot map;
  map.version = 5;
  map.cell_size_mm = kCellMm;
  for (int ty = 0; ty < 4; ++ty) {
    for (int tx = 0; tx < 20; ++tx) {
      Tile tile(0);
      for (int i = 0; i < Tile::kCells; ++i) {
        tile.set(i, {random() % 400 == 0 ? 1500 : 0, 200});
      }
      map.tiles[{0, tx, ty}] = std::make_shared<const PackedTile>(PackedTile::pack(tile));
    }
  }
  return map;
}

class CorridorsTest : public ::testing::Test {
 protected:
  KeptFields fields{25};
  MapSnapshot map = field_of_posts(3);
  PlanTarget target{
      "yard", std::make_shared<const MapSnapshot>(map), {{5.0, 16.0}, {155.0, 16.0}}, {}};
  WirePath wire;
  CorridorNeed need{.command = 4, .revision = 2, .map_version = 5};

  CorridorsTest() {
    target.planner.limits.radius_m = 0.3;
    with_field(
        [&](const KeptField& field) { wire = to_wire(field.plan(target).points_m, kCellMm); });
  }
  void with_field(const KeptFields::Use& use) { ASSERT_TRUE(fields.with(target, use)); }
  static Corridor read(const CodedPath& path, const proto::CorridorPart& part) {
    const auto begin = path.points.begin() + part.first;
    Corridor corridor =
        Corridor::along({kCellMm, {begin, begin + part.count}}, part.half_width).value();
    EXPECT_TRUE(corridor.decode(part.directions));
    return corridor;
  }
};

TEST_F(CorridorsTest, APathOnTheWireIsSmallAndIsWhatWasPlanned) {
  EXPECT_FALSE(wire.cut);
  EXPECT_EQ(decode_path(wire.bytes).value(), wire.path);
  EXPECT_LE(wire.bytes.size(), 60U * 3) << "60 bytes for 50 m";
  EXPECT_NEAR(wire.path.points_m().front().x(), 5.0, 0.02);
  EXPECT_NEAR(wire.path.points_m().back().x(), 155.0, 0.02);
}

TEST_F(CorridorsTest, APathThatIsTooLongIsCut) {
  std::vector<Eigen::Vector2d> zigzag_m;
  for (int i = 0; i < 5000; ++i) zigzag_m.emplace_back(0.3 * i, i % 2);
  const WirePath cut = to_wire(zigzag_m, kCellMm);
  EXPECT_TRUE(cut.cut);
  EXPECT_LE(cut.bytes.size(), proto::kMaxPathBytes);
  EXPECT_GE(cut.path.points.size(), 900U);
  EXPECT_EQ(decode_path(cut.bytes).value(), cut.path);
  EXPECT_TRUE(to_wire({}, kCellMm).bytes.empty());
}

TEST_F(CorridorsTest, AnOrdersCorridorCoversItsWayInSmallRecords) {
  need.stretches = kOrderStretches;
  std::vector<proto::CorridorPart> parts;
  with_field([&](const KeptField& field) { parts = corridor_along(wire.path, 0, field, need); });
  ASSERT_EQ(parts.size(), 3U);
  std::size_t covered = 0;
  std::size_t reached = 0;
  for (const proto::CorridorPart& part : parts) {
    EXPECT_EQ(part.command, 4U);
    EXPECT_EQ(part.revision, 2U);
    EXPECT_EQ(part.map_version, 5U);
    EXPECT_EQ(part.first, covered);
    EXPECT_TRUE(part.spine.empty());
    EXPECT_LE(part.directions.size(), 400U * 13 / 10) << "400 bytes for 50 m, here up to 65";
    covered += part.count - 1;
    const Corridor corridor = read(wire.path, part);
    for (std::size_t i = part.first; i + 1 < std::size_t{part.first} + part.count; ++i) {
      const CellIndex p = wire.path.points[i];
      if (corridor.direction({p.x >> 2, p.y >> 2}) <= Corridor::at_goal) ++reached;
    }
  }
  // Points at the corners of closed cells may come to lie in them.
  EXPECT_GE(reached, covered * 8 / 10);
  EXPECT_GE(covered, wire.path.points.size() * 9 / 10);
}

TEST_F(CorridorsTest, ARobotBesideItsPathGetsMoreOfIt) {
  target.request.start_m = wire.path.points_m()[4] + Eigen::Vector2d(0, 1.0);
  need.half_width = 16;
  std::vector<proto::CorridorPart> parts;
  with_field(
      [&](const KeptField& field) { parts = corridor_from(wire.path, target, field, need); });
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_TRUE(parts[0].spine.empty());
  EXPECT_GE(parts[0].first, 3U);
  EXPECT_EQ(parts[0].half_width, 16);
  (void)read(wire.path, parts[0]);
}

TEST_F(CorridorsTest, ARobotFarFromItsPathGetsAWayOfItsOwn) {
  target.request.start_m = {40.0, 25.0};
  need.half_width = 48;
  std::vector<proto::CorridorPart> parts;
  with_field(
      [&](const KeptField& field) { parts = corridor_from(wire.path, target, field, need); });
  ASSERT_EQ(parts.size(), 1U);
  ASSERT_FALSE(parts[0].spine.empty());
  EXPECT_LE(parts[0].directions.size(), proto::kMaxCorridorBytes);
  const CodedPath own = decode_path(parts[0].spine).value();
  EXPECT_NEAR((own.points_m().front() - target.request.start_m).norm(), 0.0, 0.03);
  const Corridor corridor = read(own, parts[0]);
  EXPECT_LT(corridor.direction({320, 200}), Corridor::at_goal);
}

TEST_F(CorridorsTest, WhereThereIsNoWayThereIsNoCorridor) {
  target.request.goal_m = {400.0, 16.0};
  std::vector<proto::CorridorPart> parts;
  with_field([&](const KeptField& field) {
    parts = corridor_along(wire.path, 0, field, need);
    EXPECT_TRUE(corridor_from(wire.path, target, field, need).empty());
  });
  EXPECT_TRUE(parts.empty());
}

}  // namespace
}  // namespace cairn::server
