#include "core/frontier/frontier.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/ascii_grid.h"

namespace cairn {
namespace {

using test::AsciiGrid;
using test::draw;

PlannerConfig point_robot() {
  PlannerConfig config;
  config.limits = {100, 100, 0.0};
  return config;
}

std::vector<Frontier> frontiers_of(const AsciiGrid& drawn,
                                   const FrontierConfig& config = {1, 4.0, 2.0}) {
  const DrivableGrid grid = make_drivable(drawn.grid, point_robot());
  return find_frontiers(grid, *compute_field(grid, drawn.cell('S')), config);
}

TEST(FrontierFlags, AreOpenCellsWithAnUnknownNeighbour) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    HeightGrid heights =
        empty_grid({0, 0}, {static_cast<int>(random() % 200), static_cast<int>(random() % 50)}, 125)
            .value();
    for (std::size_t i = 0; i < heights.height_mm.size(); ++i) {
      heights.probability[i] = random() % 6 == 0 ? 0 : 200;
      heights.height_mm[i] = random() % 5 == 0 ? 1000 : 0;
    }
    PlannerConfig config = point_robot();
    if (seed % 2 == 0) config.unknown = UnknownGround::allowed;
    const DrivableGrid grid = make_drivable(heights, config);
    const std::vector<std::uint64_t> flags = frontier_flags(grid);
    const auto words = static_cast<std::size_t>(heights.width + 63) / 64;
    for (int y = 0; y < heights.height; ++y) {
      for (int x = 0; x < heights.width; ++x) {
        const std::size_t at = grid.heights.at({x, y});
        bool expected = false;
        for (int d = 0; d < 8; ++d) {
          const CellIndex other{x + kStepX[d], y + kStepY[d]};
          expected = expected || (grid.heights.contains(other) &&
                                  grid.classes[grid.heights.at(other)] == CellClass::unknown);
        }
        expected = expected && grid.open[at] && grid.classes[at] != CellClass::unknown;
        const std::uint64_t word =
            flags[static_cast<std::size_t>(y) * words + static_cast<std::size_t>(x / 64)];
        ASSERT_EQ((word >> (x % 64) & 1) != 0, expected)
            << "seed " << seed << " at " << x << ' ' << y;
      }
    }
  }
}

TEST(FindFrontiers, JoinsWhatTouchesAndTellsApartWhatDoesNot) {
  const auto frontiers = frontiers_of(draw({"???....???",  //
                                            "?........?",  //
                                            "....S.....",  //
                                            "..........",  //
                                            "..........",  //
                                            "?........."}));
  ASSERT_EQ(frontiers.size(), 3U);
  std::uint32_t cells = 0;
  for (const Frontier& f : frontiers) cells += f.cells;
  EXPECT_EQ(cells, 6U + 6U + 3U);
}

TEST(FindFrontiers, LeavesOutWhatCannotBeReached) {
  const auto frontiers = frontiers_of(draw({"..#..?",  //
                                            ".S#..?",  //
                                            "..#..?"}));
  EXPECT_TRUE(frontiers.empty());
}

TEST(FindFrontiers, LeavesOutGapsBetweenBeams) {
  const AsciiGrid drawn = draw({"?.........", "..........", "S........."});
  EXPECT_EQ(frontiers_of(drawn, {3, 4.0, 2.0}).size(), 1U);
  EXPECT_TRUE(frontiers_of(drawn, {4, 4.0, 2.0}).empty());
}

TEST(FindFrontiers, PutsMoreNewGroundForLessWayFirst) {
  std::vector<std::string> rows(9, std::string(200, '.'));
  rows[4][100] = 'S';
  for (auto& row : rows) row.replace(0, 30, 30, '?');
  for (auto& row : rows) row.replace(197, 3, 3, '?');
  const auto more_ground = frontiers_of(draw(rows));
  ASSERT_EQ(more_ground.size(), 2U);
  EXPECT_LT(more_ground.front().place.x, 100) << "farther west there is more";
  for (auto& row : rows) row.replace(160, 30, 30, '?');
  const auto nearer = frontiers_of(draw(rows));
  EXPECT_GT(nearer.front().place.x, 100) << "as much, and nearer";
  EXPECT_NEAR(nearer.front().cost_m, 59 * 0.125, 0.3);
}

}  // namespace
}  // namespace cairn
