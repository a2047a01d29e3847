#include <gtest/gtest.h>

#include <limits>

#include "core/planner/trulla.h"
#include "tests/support/ascii_grid.h"

namespace cairn {
namespace {

using test::draw;
using Rows = std::vector<std::string>;

PlannerConfig with_radius(double radius_m) {
  PlannerConfig config;
  config.limits.radius_m = radius_m;
  return config;
}

/// '.' where the vehicle's centre may be, 'x' where not.
Rows open_cells(const Rows& rows, const PlannerConfig& config) {
  const DrivableGrid grid = make_drivable(draw(rows).grid, config);
  Rows drawn(rows.size(), std::string(rows.front().size(), 'x'));
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t column = 0; column < rows[row].size(); ++column) {
      const std::size_t at = (rows.size() - 1 - row) * rows.front().size() + column;
      if (grid.open[at]) drawn[row][column] = '.';
    }
  }
  return drawn;
}

TEST(MakeDrivable, ClosesADiscOfTheRadiusAroundAnObstacle) {
  const Rows post = {".......", ".......", ".......", "...#...", ".......", ".......", "......."};
  EXPECT_EQ(open_cells(post, with_radius(0.30)), (Rows{".......",  //
                                                       "..xxx..",  //
                                                       ".xxxxx.",  //
                                                       ".xxxxx.",  //
                                                       ".xxxxx.",  //
                                                       "..xxx..",  //
                                                       "......."}));
}

TEST(MakeDrivable, LeavesACellOpenThatLiesExactlyAtTheRadius) {
  EXPECT_EQ(open_cells({"#...."}, with_radius(0.25)), (Rows{"xx..."}));
  EXPECT_EQ(open_cells({"#...."}, with_radius(0.251)), (Rows{"xxx.."}));
  EXPECT_EQ(open_cells({"#...."}, with_radius(0.0)), (Rows{"x...."}));
}

TEST(MakeDrivable, OpensUnknownGroundOnlyWhenAllowed) {
  PlannerConfig config = with_radius(0.0);
  EXPECT_EQ(open_cells({".?.#?"}, config), (Rows{".x.xx"}));
  config.unknown = UnknownGround::allowed;
  EXPECT_EQ(open_cells({".?.#?"}, config), (Rows{"...x."}));
  config.limits.radius_m = 0.2;
  EXPECT_EQ(open_cells({".?.#?"}, config), (Rows{"..xxx"}));
}

TEST(WhyClosed, SaysWhatIsThere) {
  const auto drawn = draw({"a?....b.#c"});
  const DrivableGrid grid = make_drivable(drawn.grid, with_radius(0.35));
  EXPECT_EQ(why_closed(grid, drawn.cell('a')), "");
  EXPECT_EQ(why_closed(grid, {1, 0}),
            "is on ground nobody has seen: allow unknown ground or pick another");
  EXPECT_EQ(why_closed(grid, drawn.cell('b')),
            "is 0.25 m from an obstacle, nearer than the vehicle's radius 0.35 m");
  EXPECT_EQ(why_closed(grid, {8, 0}), "is on an obstacle");
  EXPECT_EQ(why_closed(grid, {10, 0}), "lies outside the map");
}

TEST(PlannerConfig, NamesEveryFaultAtOnce) {
  EXPECT_EQ(faults(PlannerConfig{}), "");
  PlannerConfig config;
  config.limits = {-1, -1, 11};
  config.unknown_price = 0.5;
  config.climb_effort = std::numeric_limits<double>::quiet_NaN();
  config.descend_effort = 101;
  EXPECT_EQ(faults(config),
            "climb_mm must not be negative; descend_mm must not be negative; radius_m must be from "
            "0 to 10; unknown_price must be from 1 to 30; climb_effort must be from 0 to 100; "
            "descend_effort must be from 0 to 100");
}

}  // namespace
}  // namespace cairn
