#include "core/planner/corridor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
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
    Corridor corridor = Corridor::along(d.path, 12).value();  // 1.5 m to each side.
    corridor.fill(d.grid, d.field);
    EXPECT_LE(encode_path(d.path).size(), 60U) << "seed " << seed;
    EXPECT_LE(corridor.encode().size(), 400U) << "seed " << seed << ", " << corridor.cells();
  }
}

TEST(Corridor, ComesBackAsItWasAndLeadsToTheGoal) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Drive d = drive(seed);
    Corridor sent = Corridor::along(d.path, 8).value();
    sent.fill(d.grid, d.field);
    Corridor got = Corridor::along(decode_path(encode_path(d.path)).value(), 8).value();
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
  const Corridor corridor = Corridor::along(d.path, 8).value();
  EXPECT_EQ(corridor.direction({-20, 170}), Corridor::outside);
  EXPECT_EQ(corridor.direction({1'000'000'000, -1'000'000'000}), Corridor::outside);
  EXPECT_GT(corridor.cells(), 400U * 15);
}

TEST(Corridor, RefusesWhatIsTooLarge) {
  const CodedPath across{125, {{0, 0}, {CodedPath::kFarthest - 1, CodedPath::kFarthest - 1}}};
  EXPECT_EQ(Corridor::along(across, 8).error().code, ErrorCode::exhausted);
  CodedPath to_and_fro{125, {}};
  for (int i = 0; i < 4096; ++i) to_and_fro.points.push_back({i % 2 * 8000, i % 2 * 8000});
  EXPECT_EQ(Corridor::along(to_and_fro, 8).error().code, ErrorCode::exhausted);
  EXPECT_FALSE(Corridor::along({125, {}}, 8));
  EXPECT_FALSE(Corridor::along({125, {{0, 0}}}, -1));
  EXPECT_FALSE(Corridor::along({125, {{0, 0}}}, Corridor::kMaxHalfWidth + 1));
}

TEST(Corridor, HoldsTheCellsWhoseMiddlesAreNearThePathAndNoOthers) {
  std::mt19937 random(4);
  for (int round = 0; round < 20; ++round) {
    CodedPath path{125, {}};
    for (int i = 0; i < 5; ++i) {
      path.points.push_back(
          {static_cast<int>(random() % 300) - 150, static_cast<int>(random() % 300) - 150});
    }
    const int half_width = 1 + static_cast<int>(random() % 9);
    const Corridor corridor = Corridor::along(path, half_width).value();
    for (int y = -60; y < 60; ++y) {
      for (int x = -60; x < 60; ++x) {
        const Eigen::Vector2d p(4 * x + 2, 4 * y + 2);
        double nearest = 1e9;
        for (std::size_t i = 1; i < path.points.size(); ++i) {
          const Eigen::Vector2d a(path.points[i - 1].x, path.points[i - 1].y);
          const Eigen::Vector2d way = Eigen::Vector2d(path.points[i].x, path.points[i].y) - a;
          const double t =
              std::clamp((p - a).dot(way) / std::max(way.squaredNorm(), 1.0), 0.0, 1.0);
          nearest = std::min(nearest, (p - a - t * way).norm());
        }
        if (std::abs(nearest - 4 * half_width) < 1e-6) continue;
        ASSERT_EQ(corridor.direction({x, y}) != Corridor::outside, nearest < 4 * half_width)
            << "round " << round << ": " << x << ", " << y;
      }
    }
  }
}

TEST(CodedPath, IsSubdividedWithoutLeavingItsWay) {
  const CodedPath path{125, {{0, 0}, {1000, -7}, {1000, -8}, {1000, 800}}};
  const CodedPath fine = subdivided(path, 300);
  EXPECT_EQ(fine.points.front(), path.points.front());
  EXPECT_EQ(fine.points.back(), path.points.back());
  EXPECT_EQ(fine.points.size(), 4U + 3 + 2);
  for (std::size_t i = 1; i < fine.points.size(); ++i) {
    EXPECT_LE(std::abs(fine.points[i].x - fine.points[i - 1].x), 300);
    EXPECT_LE(std::abs(fine.points[i].y - fine.points[i - 1].y), 300);
  }
  EXPECT_EQ(subdivided(fine, 300), fine);
}

TEST(Corridor, SurvivesAnyBytes) {
  const Drive d = drive(1);
  std::mt19937 random(9);
  for (int i = 0; i < 300; ++i) {
    std::vector<std::uint8_t> bytes(random() % 300);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const auto path = decode_path(bytes);
    EXPECT_TRUE(!path || path->points.size() <= CodedPath::kMaxPoints);
    Corridor corridor = Corridor::along(d.path, 2).value();
    if (!corridor.decode(bytes)) continue;
    EXPECT_LE(corridor.direction(open_cell(d.grid, {-20, 60})), Corridor::outside);
  }
}

}  // namespace
}  // namespace cairn
