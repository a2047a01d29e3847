#include "core/planner/corridor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/planner/plan.h"

namespace cairn {
namespace {

PlannerConfig vehicle() {
  PlannerConfig config;
  config.limits.radius_m = 0.2;
  return config;
}

/// 60 × 20 m of hills with some posts.
DrivableGrid yard(unsigned seed) {
  std::mt19937 random(seed);
  HeightGrid heights = empty_grid({-40, 20}, {439, 179}, 125).value();
  for (std::size_t i = 0; i < heights.height_mm.size(); ++i) {
    heights.probability[i] = 200;
    const double x = static_cast<double>(i % 480);
    const double y = static_cast<double>(i / 480);
    const double hills_mm = 300 * std::sin(x / 70) * std::cos(y / 50);
    heights.height_mm[i] = random() % 300 == 0 ? 1500 : static_cast<std::int32_t>(hills_mm);
  }
  return make_drivable(std::move(heights), vehicle());
}

Eigen::Vector2d middle(CellIndex c) { return {(c.x + 0.5) * 0.125, (c.y + 0.5) * 0.125}; }

CellIndex open_cell(const DrivableGrid& grid, CellIndex cell) {
  while (!grid.open[grid.heights.at(cell)]) ++cell.y;
  return cell;
}

struct Drive {
  DrivableGrid grid;
  Field field;
  CodedPath path;
};

/// About 50 m across the yard.
Drive drive(unsigned seed) {
  DrivableGrid grid = yard(seed);
  const CellIndex start = open_cell(grid, {-20, 60});
  const CellIndex goal = open_cell(grid, {380, 120});
  Field field = compute_field(grid, goal).value();
  const Path path = plan(grid, {middle(start), middle(goal)}, vehicle());
  CodedPath coded = quantise(path.points_m, 125).value();
  return {std::move(grid), std::move(field), std::move(coded)};
}

TEST(CodedPath, ComesBackWithinAnEighthOfACell) {
  const std::vector<Eigen::Vector2d> points_m = {{-3.07, 8.4}, {50.01, -0.3}, {50.02, -0.31}};
  const CodedPath path = quantise(points_m, 125).value();
  const CodedPath back = decode_path(encode_path(path)).value();
  EXPECT_EQ(back, path);
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    EXPECT_LE((back.points_m()[i] - points_m[i]).cwiseAbs().maxCoeff(), 0.125 / 8 + 1e-9);
  }
  EXPECT_FALSE(quantise({{1e9, 0}}, 125));
  EXPECT_FALSE(quantise({{std::nan(""), 0}}, 125));
}

TEST(Corridor, FiftyMetresFitIntoFourHundredBytes) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Drive d = drive(seed);
    Corridor corridor = Corridor::along(d.path, 1.0).value();
    corridor.fill(d.grid, d.field);
    EXPECT_LE(encode_path(d.path).size(), 60U) << "seed " << seed;
    EXPECT_LE(corridor.encode().size(), 400U) << "seed " << seed << ", " << corridor.cells();
  }
}

TEST(Corridor, ComesBackAsItWasAndLeadsToTheGoal) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Drive d = drive(seed);
    Corridor sent = Corridor::along(d.path, 1.0).value();
    sent.fill(d.grid, d.field);
    Corridor got = Corridor::along(decode_path(encode_path(d.path)).value(), 1.0).value();
    ASSERT_TRUE(got.decode(sent.encode()));
    ASSERT_EQ(got, sent) << "seed " << seed;
    CellIndex cell = open_cell(d.grid, {-20, 60});
    for (int step = 0; step < 1000 && got.direction(cell) < Corridor::at_goal; ++step) {
      const std::uint32_t before = cost_to_goal(d.grid, d.field, cell);
      ASSERT_NE(step_cost(d.grid, cell, got.direction(cell)), kNoWay);
      cell = {cell.x + kStepX[got.direction(cell)], cell.y + kStepY[got.direction(cell)]};
      ASSERT_LT(cost_to_goal(d.grid, d.field, cell), before);
    }
    EXPECT_NE(got.direction(cell), Corridor::no_way);
  }
}

TEST(Corridor, IsOutsideElsewhere) {
  const Drive d = drive(3);
  const Corridor corridor = Corridor::along(d.path, 1.0).value();
  EXPECT_EQ(corridor.direction({-20, 170}), Corridor::outside);
  EXPECT_EQ(corridor.direction({1'000'000'000, -1'000'000'000}), Corridor::outside);
  EXPECT_GT(corridor.cells(), 400U * 15);
}

TEST(Corridor, RefusesWhatIsTooLarge) {
  const CodedPath across{125, {{0, 0}, {CodedPath::kFarthest - 1, CodedPath::kFarthest - 1}}};
  EXPECT_EQ(Corridor::along(across, 1.0).error().code, ErrorCode::exhausted);
  EXPECT_FALSE(Corridor::along({125, {}}, 1.0));
  EXPECT_FALSE(Corridor::along({125, {{0, 0}}}, std::nan("")));
}

TEST(Corridor, SurvivesAnyBytes) {
  const Drive d = drive(1);
  std::mt19937 random(9);
  for (int i = 0; i < 300; ++i) {
    std::vector<std::uint8_t> bytes(random() % 300);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const auto path = decode_path(bytes);
    EXPECT_TRUE(!path || path->points.size() <= CodedPath::kMaxPoints);
    Corridor corridor = Corridor::along(d.path, 0.3).value();
    if (!corridor.decode(bytes)) continue;
    EXPECT_LE(corridor.direction(open_cell(d.grid, {-20, 60})), Corridor::outside);
  }
}

}  // namespace
}  // namespace cairn
