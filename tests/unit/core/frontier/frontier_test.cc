#include "core/frontier/frontier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <string>
#include <vector>

#include "core/frontier/reach.h"

namespace cairn {
namespace {

/// '.' ground, '#' a wall 1 m high, ' ' unseen; the first row is the northernmost. Cells of 1 m.
DrivableGrid drawn(const std::vector<std::string>& rows, double radius_m = 0.0) {
  const auto height = static_cast<std::int32_t>(rows.size());
  const auto width = static_cast<std::int32_t>(rows[0].size());
  HeightGrid grid = empty_grid({0, 0}, {width - 1, height - 1}, 1000).value();
  for (std::int32_t y = 0; y < height; ++y) {
    for (std::int32_t x = 0; x < width; ++x) {
      const char c = rows[static_cast<std::size_t>(height - 1 - y)][static_cast<std::size_t>(x)];
      grid.probability[grid.at({x, y})] = c == ' ' ? 0 : 200;
      grid.height_mm[grid.at({x, y})] = c == '#' ? 1000 : 0;
    }
  }
  PlannerConfig config;
  config.limits.radius_m = radius_m;
  return make_drivable(std::move(grid), config);
}

constexpr FrontierConfig kSmall{.reach_m = 1.5, .view_m = 2.5, .min_area_m2 = 0.5};

TEST(Frontiers, AreWhereReachableGroundMeetsTheUnseen) {
  const DrivableGrid grid = drawn({"#######",  //
                                   "#....  ",  //
                                   "#....  ",  //
                                   "#######"});
  const auto found = find_frontiers(grid, {1.5, 1.5}, kSmall);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].place_m, Eigen::Vector2d(4.5, 1.5));
  EXPECT_EQ(found[0].way_m, 3.0);
  EXPECT_EQ(found[0].edge.size(), 2U);
  EXPECT_EQ(found[0].new_area_m2, 4.0);
}

TEST(Frontiers, BehindWallsAreNotReachable) {
  const DrivableGrid grid = drawn({"########",  //
                                   "#..#... ",  //
                                   "########"});
  EXPECT_TRUE(find_frontiers(grid, {1.5, 1.5}, kSmall).empty());
  EXPECT_EQ(find_frontiers(grid, {4.5, 1.5}, kSmall).size(), 1U);
}

TEST(Frontiers, AreRankedByNewGroundForTheWay) {
  const DrivableGrid grid = drawn({"###########",  //
                                   "# .......  ",  //
                                   "###########"});
  // From the middle the larger one is chosen, from beside it the smaller one.
  const auto middle = find_frontiers(grid, {5.5, 1.5}, kSmall);
  ASSERT_EQ(middle.size(), 2U);
  EXPECT_GT(middle[0].place_m.x(), 5.0);
  FrontierConfig eager = kSmall;
  eager.head_start_m = 0.5;
  const auto beside = find_frontiers(grid, {3.5, 1.5}, eager);
  ASSERT_EQ(beside.size(), 2U);
  EXPECT_LT(beside[0].place_m.x(), 5.0);
}

TEST(Frontiers, OfTooLittleGroundAreLeftAlone) {
  const DrivableGrid grid = drawn({"......",  //
                                   "... ..",  //
                                   "......"});
  FrontierConfig config = kSmall;
  config.reach_m = 3.0;
  EXPECT_EQ(find_frontiers(grid, {0.5, 0.5}, config).size(), 1U);
  config.min_area_m2 = 1.5;
  EXPECT_TRUE(find_frontiers(grid, {0.5, 0.5}, config).empty());
}

TEST(Frontiers, OutsideTheAreaDoNotCount) {
  const DrivableGrid grid = drawn({" ........ ",  //
                                   " ........ "});
  const auto all = find_frontiers(grid, {4.5, 0.5}, kSmall);
  const auto east = find_frontiers(grid, {4.5, 0.5}, kSmall, AreaM{5.0, 0.0, 10.0, 2.0});
  EXPECT_EQ(all.size(), 2U);
  ASSERT_EQ(east.size(), 1U);
  EXPECT_GT(east[0].place_m.x(), 5.0);
}

TEST(Frontiers, KeepTheVehiclesRoom) {
  const DrivableGrid grid = drawn({"#########",  //
                                   "#.......#",  //
                                   "#.......#",  //
                                   "#.......#",  //
                                   "####.####",  //
                                   "####.####",  //
                                   "    .    "},
                                  1.4);
  EXPECT_TRUE(find_frontiers(grid, {4.5, 4.5}, kSmall).empty());
}

TEST(Frontiers, AVehicleInATightPlaceFindsItsWayOut) {
  const DrivableGrid grid = drawn({"......  ",  //
                                   "......  ",  //
                                   "......  ",  //
                                   "#.....  "},
                                  1.4);
  EXPECT_FALSE(find_frontiers(grid, {1.5, 0.5}, kSmall).empty());
}

TEST(Frontiers, OfAPlaceOffTheMapAreNone) {
  const DrivableGrid grid = drawn({". "});
  EXPECT_TRUE(find_frontiers(grid, {-5.0, 0.0}, kSmall).empty());
  EXPECT_TRUE(find_frontiers(grid, {1e9, std::nan("")}, kSmall).empty());
}

/// The wave by the plainest means: repeat until nothing changes.
std::vector<std::uint32_t> plain_reach(const DrivableGrid& grid, CellIndex start) {
  const HeightGrid& h = grid.heights;
  std::vector<std::uint32_t> way(grid.open.size(), Reach::kNone);
  way[h.at(start)] = 0;
  const auto open = [&](int x, int y) {
    return h.contains({x, y}) && grid.open[h.at({x, y})] != 0;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (int y = 0; y < h.height; ++y) {
      for (int x = 0; x < h.width; ++x) {
        const std::uint32_t here = way[h.at({x, y})];
        for (int d = 0; d < 8 && here != Reach::kNone; ++d) {
          const int dx = kStepX[d];
          const int dy = kStepY[d];
          if (!open(x + dx, y + dy) || !open(x + dx, y) || !open(x, y + dy)) continue;
          std::uint32_t& there = way[h.at({x + dx, y + dy})];
          const std::uint32_t longer = here + (dx != 0 && dy != 0 ? 7 : 5);
          if (longer < there) changed = true, there = longer;
        }
      }
    }
  }
  return way;
}

TEST(Reach, IsThatOfAPlainWaveOnRandomGround) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<std::string> rows(1 + random() % 12, std::string(1 + random() % 12, '.'));
    for (std::string& row : rows) {
      for (char& c : row) c = random() % 4 == 0 ? '#' : random() % 9 == 0 ? ' ' : '.';
    }
    const DrivableGrid grid = drawn(rows);
    const CellIndex start{0, 0};
    if (grid.open[0] == 0) continue;
    EXPECT_EQ(reach_from(grid, {0.5, 0.5}).way, plain_reach(grid, start)) << "trial " << trial;
  }
}

}  // namespace
}  // namespace cairn
