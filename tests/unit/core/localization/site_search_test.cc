#include "core/localization/site_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/common/angle.h"
#include "core/localization/site_places.h"
#include "tests/unit/core/localization/test_ground.h"

namespace cairn {
namespace {

using test::kCellMm;

/// What a robot in the middle of a short-term map of 8 × 8 m knows.
const Pose kRobotInMap{0.4, -0.3, 0.0, 0.0, 0.0, 0.2};

/// Where the short-term map lies when its robot stands at (x, y).
template <class Ground>
Pose map_of_robot_at(const Ground& ground, double x_m, double y_m, double yaw_rad) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return {x_m - c * kRobotInMap.x_m + s * kRobotInMap.y_m,
          y_m - s * kRobotInMap.x_m - c * kRobotInMap.y_m,
          ground(x_m, y_m),
          0.0,
          0.0,
          yaw_rad};
}

SiteSearchConfig small_config() {
  SiteSearchConfig config;
  config.reach_m = 5.0;
  config.yaw_step_rad = radians(2.0);
  config.max_blocked = 1.0;  // These maps are seen from above, see the test of sight lines.
  return config;
}

/// A site of 30 × 30 m and the search in it.
template <class Ground>
struct Site {
  Ground ground;
  std::mt19937_64 random{4};
  HeightMap map = test::long_term_of(ground, random, 0.9);
  SiteSearch search{map, small_config()};

  HeightMap seen_at(double x_m, double y_m, double yaw_rad) {
    return test::short_term_of(ground, map_of_robot_at(ground, x_m, y_m, yaw_rad), random);
  }
};

/// Gentle hills with boxes on them, different everywhere and for every seed.
struct TownGround {
  std::uint64_t seed = 1;

  [[nodiscard]] bool box(double x, double y) const {
    std::uint64_t h = seed * 1'000'003;
    for (const double v : {x, y}) {
      h = (h ^ static_cast<std::uint64_t>(std::floor(v / 1.1) + 1000.0)) * 0x9E3779B97F4A7C15U;
      h ^= h >> 29U;
    }
    return h % 5 == 0;
  }
  double operator()(double x, double y) const {
    return 0.2 * std::sin(0.23 * x + 0.3) * std::cos(0.31 * y) + (box(x, y) ? 0.5 : 0.0);
  }
};

/// The same twice, 12 m apart.
struct TwinGround {
  [[nodiscard]] static double first(double x) { return x - 12.0 * std::floor(x / 12.0); }
  [[nodiscard]] bool box(double x, double y) const { return TownGround{}.box(first(x), y); }
  double operator()(double x, double y) const { return TownGround{}(first(x), y); }
};

/// A half turn around the origin does not change it.
struct HalfTurnGround {
  double operator()(double x, double y) const {
    const TownGround town;
    return x > 0.0 || (x == 0.0 && y > 0.0) ? town(x, y) : town(-x, -y);
  }
};

void expect_found(const SiteMatch& match, double x_m, double y_m, double yaw_rad) {
  ASSERT_TRUE(match.accepted) << match.why << "; bounds " << match.bound_mm << ", "
                              << match.second_bound_mm << ", scores " << match.score_mm << ", "
                              << match.second_best_mm;
  EXPECT_NEAR(match.T_site_robot.x_m, x_m, 0.08);
  EXPECT_NEAR(match.T_site_robot.y_m, y_m, 0.08);
  EXPECT_NEAR(wrap_angle(match.T_site_robot.yaw_rad - yaw_rad - kRobotInMap.yaw_rad), 0.0, 0.02);
}

struct Spot {
  double x_m, y_m, yaw_rad;
};

/// Places where a robot can stand: not on a box.
std::vector<Spot> spots(int count, const TownGround& ground = {}) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> place(-9.0, 9.0);
  std::uniform_real_distribution<double> yaw(-std::numbers::pi, std::numbers::pi);
  std::vector<Spot> all;
  while (static_cast<int>(all.size()) < count) {
    const Spot spot{place(random), place(random), yaw(random)};
    if (!ground.box(spot.x_m, spot.y_m)) all.push_back(spot);
  }
  return all;
}

TEST(SiteSearch, findsTheRobotAnywhereAndHoweverItIsTurned) {
  Site<TownGround> site;
  for (const Spot& spot : spots(12)) {
    SCOPED_TRACE(testing::Message() << spot.x_m << ", " << spot.y_m << ", " << spot.yaw_rad);
    const SiteMatch match =
        site.search.find(site.seen_at(spot.x_m, spot.y_m, spot.yaw_rad), kRobotInMap);
    expect_found(match, spot.x_m, spot.y_m, spot.yaw_rad);
    EXPECT_NEAR(match.T_site_robot.z_m, site.ground(spot.x_m, spot.y_m), 0.05);
    EXPECT_LT(match.bound_mm, match.second_bound_mm);
  }
}

TEST(SiteSearch, theHeightOfTheShortTermMapsOriginDoesNotMatter) {
  Site<TownGround> site;
  const Spot spot = spots(1).front();
  const HeightMap seen = site.seen_at(spot.x_m, spot.y_m, spot.yaw_rad);
  HeightMap lifted(kCellMm);
  for (const auto& [key, tile] : seen.tiles()) {
    for (int i = 0; i < Tile::kCells; ++i) {
      if (!tile->known(i)) continue;
      lifted.set({key.tx * Tile::kSize + i % Tile::kSize, key.ty * Tile::kSize + i / Tile::kSize},
                 {tile->height_mm(i) + 7000, 200});
    }
  }
  Pose robot = kRobotInMap;
  robot.z_m = 7.0;
  expect_found(site.search.find(lifted, robot), spot.x_m, spot.y_m, spot.yaw_rad);
}

TEST(SiteSearch, refusesWhatIsNotInTheMap) {
  Site<TownGround> site;
  const TownGround other{2};
  for (const Spot& spot : spots(6, other)) {
    const HeightMap seen = test::short_term_of(
        other, map_of_robot_at(other, spot.x_m, spot.y_m, spot.yaw_rad), site.random);
    const SiteMatch match = site.search.find(seen, kRobotInMap);
    EXPECT_FALSE(match.accepted);
    EXPECT_EQ(match.why, "it looks like no place of the map");
  }
}

TEST(SiteSearch, refusesLevelGroundWithoutAFeature) {
  Site<test::FlatGround> site;
  const SiteMatch match = site.search.find(site.seen_at(1.0, 2.0, 0.3), kRobotInMap);
  EXPECT_FALSE(match.accepted);
  EXPECT_EQ(match.why, "the short-term map shows too little");
}

TEST(SiteSearch, refusesACorridorThatIsTheSameAllAlong) {
  Site<test::Corridor> site;
  const SiteMatch match = site.search.find(site.seen_at(1.0, 0.2, 0.3), kRobotInMap);
  EXPECT_FALSE(match.accepted);
  EXPECT_FALSE(match.why.empty());
}

TEST(SiteSearch, refusesAPlaceThatIsThereTwice) {
  Site<TwinGround> site;
  const SiteMatch match = site.search.find(site.seen_at(-6.0, 0.5, 0.3), kRobotInMap);
  EXPECT_FALSE(match.accepted);
  EXPECT_EQ(match.why, "another place matches as well");
}

TEST(SiteSearch, refusesAPlaceThatLooksTheSameFromTheOppositeSide) {
  Site<HalfTurnGround> site;
  const SiteMatch match = site.search.find(site.seen_at(6.0, -2.0, 0.3), kRobotInMap);
  EXPECT_FALSE(match.accepted);
  EXPECT_EQ(match.why, "another place matches as well");
}

TEST(SiteSearch, aDiscTellsTwinsApart) {
  Site<TwinGround> site;
  const HeightMap seen = site.seen_at(-6.0, 0.5, 0.3);
  expect_found(site.search.find(seen, kRobotInMap, SiteDisc{-5.0, 1.0, 4.0}), -6.0, 0.5, 0.3);
  expect_found(site.search.find(seen, kRobotInMap, SiteDisc{5.0, 1.0, 4.0}), 6.0, 0.5, 0.3);
  const SiteSearch prepared_for_disc(site.map, small_config(), SiteDisc{5.0, 1.0, 4.0});
  expect_found(prepared_for_disc.find(seen, kRobotInMap, SiteDisc{5.0, 1.0, 4.0}), 6.0, 0.5, 0.3);
}

TEST(SiteSearch, findsNothingOutsideOfTheDisc) {
  Site<TownGround> site;
  const HeightMap seen = site.seen_at(-6.0, 0.5, 0.3);
  EXPECT_FALSE(site.search.find(seen, kRobotInMap, SiteDisc{6.0, 0.5, 4.0}).accepted);
}

TEST(SiteSearch, refusesBadInputWithAReason) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Site<TownGround> site;
  const HeightMap seen = site.seen_at(spots(1)[0].x_m, spots(1)[0].y_m, 0.3);
  const auto refused = [](const SiteMatch& match) { return !match.accepted && !match.why.empty(); };
  EXPECT_TRUE(refused(site.search.find(HeightMap(kCellMm), kRobotInMap)));
  EXPECT_TRUE(refused(site.search.find(seen, Pose{kNan})));
  EXPECT_TRUE(refused(site.search.find(seen, Pose{1e300})));
  EXPECT_TRUE(refused(site.search.find(seen, Pose{50.0, 50.0})));
  EXPECT_TRUE(refused(site.search.find(seen, Pose{0.0, 0.0, 90.0})));
  EXPECT_TRUE(refused(site.search.find(seen, kRobotInMap, SiteDisc{kNan, 0.0, 1.0})));
  EXPECT_TRUE(refused(site.search.find(seen, kRobotInMap, SiteDisc{0.0, 0.0, -1.0})));
  EXPECT_TRUE(refused(SiteSearch(HeightMap(kCellMm)).find(seen, kRobotInMap)));
}

TEST(SiteSearch, refusesASiteThatIsTooLargeOrTooSteep) {
  Site<TownGround> site;
  const HeightMap seen = site.seen_at(spots(1)[0].x_m, spots(1)[0].y_m, 0.3);
  HeightMap wide = site.map;
  wide.set({700'000, 0}, {0, 200});
  EXPECT_EQ(SiteSearch(wide, small_config()).find(seen, kRobotInMap).why,
            "the site is too large to be searched at once; give a disc");
  expect_found(SiteSearch(wide, small_config(), SiteDisc{0.0, 0.0, 15.0}).find(seen, kRobotInMap),
               spots(1)[0].x_m, spots(1)[0].y_m, 0.3);
  HeightMap steep = site.map;
  steep.set({200, 200}, {900'000, 200});
  EXPECT_EQ(SiteSearch(steep, small_config()).find(seen, kRobotInMap).why,
            "the site's heights differ too much");
}

TEST(SiteSearch, refusesAPlaceFromWhichNobodyCouldSeeWhatWasSeen) {
  Site<TownGround> site;
  SiteSearchConfig config = small_config();
  config.max_blocked = 0.2;  // In a robot's own map hardly any sight line is blocked.
  const HeightMap seen_from_above = site.seen_at(7.2, -6.35, 2.39);
  ASSERT_TRUE(site.search.find(seen_from_above, kRobotInMap).accepted);
  const SiteMatch match = SiteSearch(site.map, config).find(seen_from_above, kRobotInMap);
  EXPECT_FALSE(match.accepted);
  EXPECT_EQ(match.why, "what was seen cannot be seen from there");
}

TEST(SiteSearch, saysSoWhenTheWorkIsMoreThanAllowed) {
  Site<TownGround> site;
  SiteSearchConfig config = small_config();
  config.max_bounds = 10;
  const Spot spot = spots(1).front();
  const SiteMatch match = SiteSearch(site.map, config)
                              .find(site.seen_at(spot.x_m, spot.y_m, spot.yaw_rad), kRobotInMap);
  EXPECT_FALSE(match.accepted);
  EXPECT_EQ(match.why, "too many places look alike");
}

/// The least sum of all places and turns, one by one, by the same rule.
std::uint32_t least_by_trying_all(const SiteGround& ground, const SitePyramid& pyramid,
                                  const std::vector<ShownCell>& cells, double cell_m, int yaws) {
  std::uint32_t least = std::numeric_limits<std::uint32_t>::max();
  for (int yaw = 0; yaw < yaws; ++yaw) {
    const std::vector<SitePoint> points =
        turned_points(cells, yaw * 2.0 * std::numbers::pi / yaws, ground.unit_mm, cell_m, 0.006);
    for (int y = ground.margin; y < ground.heights.height - ground.margin; ++y) {
      for (int x = ground.margin; x < ground.heights.width - ground.margin; ++x) {
        if (!ground.floor.at(x, y).any()) continue;
        std::uint32_t sum = 0;
        for (const SitePoint& point : points) {
          int nearest = ground.truncate;
          for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
              const HeightSpan& there = ground.heights.at(x + point.x + dx, y + point.y + dy);
              nearest =
                  std::min<int>(nearest, least_difference(point, there, ground.floor.at(x, y)));
            }
          }
          sum += static_cast<std::uint32_t>(nearest);
        }
        least = std::min(least, sum);
        // A block's bound is never above what its places score.
        for (int level = 0; level <= SitePyramid::kTop; ++level) {
          const int first_x = x - (x - ground.margin) % (1 << level);
          const int first_y = y - (y - ground.margin) % (1 << level);
          const std::uint32_t bound = pyramid.bound(level, first_x, first_y, points,
                                                    std::numeric_limits<std::uint32_t>::max());
          EXPECT_LE(bound, sum) << "level " << level << " at " << x << ", " << y;
        }
      }
    }
  }
  return least;
}

TEST(SitePlaces, boundsAreNeverAboveWhatTheirPlacesScoreAndTheBestIsNotMissed) {
  constexpr int kYaws = 8;
  const test::RichGround rich;
  std::mt19937_64 random(12);
  const HeightMap map = test::sampled_map(
      rich, Pose{}, {.half_cells = 24, .hits_per_cell = 4, .noise_m = 0.02, .known_share = 0.7},
      kCellMm, random);
  const HeightMap seen = test::sampled_map(
      rich, map_of_robot_at(rich, 0.6, -0.8, 0.7),
      {.half_cells = 12, .hits_per_cell = 2, .noise_m = 0.02, .known_share = 0.7}, kCellMm, random);
  const std::vector<ShownCell> cells = shown_cells(seen, kRobotInMap, 2.0, 60, 60);
  std::string why;
  const auto ground = read_site_ground(map, 18, std::nullopt, {}, why);
  ASSERT_TRUE(ground) << why;
  const SitePyramid pyramid(*ground);
  const std::uint32_t least =
      least_by_trying_all(*ground, pyramid, cells, map.cell_size_m(), kYaws);
  SitePlaces places(
      *ground, pyramid, map.cell_size_m(), cells,
      {.yaw_step_rad = 2.0 * std::numbers::pi / kYaws, .limit_mm = 400.0, .disc = {}});
  const auto best = places.next(400.0, {});
  ASSERT_TRUE(best);
  EXPECT_LE(best->sum, least);  // Each cell may take its lowest and highest from neighbours.
}

TEST(SitePyramid, theBoundsOfAllTopBlocksAreThoseOfEach) {
  const test::RichGround rich;
  std::mt19937_64 random(13);
  const HeightMap map = test::long_term_of(rich, random, 0.6);
  const HeightMap seen = test::short_term_of(rich, map_of_robot_at(rich, 2.0, 1.0, 0.7), random);
  std::string why;
  const auto ground = read_site_ground(map, 42, std::nullopt, {}, why);
  ASSERT_TRUE(ground) << why;
  const SitePyramid pyramid(*ground);
  const std::vector<SitePoint> points =
      turned_points(shown_cells(seen, kRobotInMap, 5.0, 256, 128), 0.7, ground->unit_mm,
                    map.cell_size_m(), 0.006);
  std::vector<std::uint16_t> sums;
  pyramid.top_bounds(points, sums);
  int compared = 0;
  for (int j = 0; j < pyramid.top_rows(); ++j) {
    for (int i = 0; i < pyramid.top_columns(); ++i) {
      const int x = ground->margin + i * SitePyramid::kTopCells;
      const int y = ground->margin + j * SitePyramid::kTopCells;
      if (!pyramid.floor(SitePyramid::kTop, x, y).any()) continue;
      EXPECT_EQ(sums[static_cast<std::size_t>(j * pyramid.top_stride() + i)],
                pyramid.bound(SitePyramid::kTop, x, y, points, 1'000'000));
      ++compared;
    }
  }
  EXPECT_GT(compared, 50);
}

}  // namespace
}  // namespace cairn
