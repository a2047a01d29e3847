#include "core/map/update.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <utility>

#include "core/map/walk_cells.h"

namespace cairn {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kCellMm = 1000;  // So that cells are whole metres.
const SensorModel kModel;

Beam hit_beam(double x, double y, double z, double from_x = 0.5, double from_z = 0.4) {
  return {{from_x, 0.5, from_z}, {x, y, z}, true};
}

Beam free_beam(double x, double y, double z) { return {{0.5, 0.5, 0.4}, {x, y, z}, false}; }

class ScanIntegratorTest : public testing::Test {
 protected:
  ScanEffect integrate(const std::vector<Beam>& beams) {
    return integrator.integrate(map, beams, std::nullopt, nullptr);
  }

  HeightMap map{kCellMm};
  HeightMap reference{kCellMm};
  ScanIntegrator integrator{kModel};
};

TEST_F(ScanIntegratorTest, AHitIsStoredInItsCellInMillimetres) {
  const ScanEffect effect = integrate({hit_beam(5.5, 0.5, 0.7314)});
  EXPECT_EQ(map.cell({5, 0}), (Cell{731, kModel.hit_probability}));
  EXPECT_EQ(map.known_count(), 1U);
  EXPECT_EQ(effect.beams, 1);
  EXPECT_THAT(effect.changed, ElementsAre(CellIndex{5, 0}));
}

TEST_F(ScanIntegratorTest, HeightsBelowTheOriginRoundToNearestToo) {
  integrate({hit_beam(5.5, 0.5, -0.0126), hit_beam(6.5, 0.5, -0.0124)});
  EXPECT_EQ(map.cell({5, 0}).height_mm, -13);
  EXPECT_EQ(map.cell({6, 0}).height_mm, -12);
}

TEST_F(ScanIntegratorTest, ABeamWeakensWhatItPassesBelow) {
  map.set({3, 0}, {1000, 200});
  integrate({hit_beam(9.5, 0.5, 0.4)});
  EXPECT_EQ(map.cell({3, 0}), (Cell{1000, combine(200, kModel.miss_probability)}));
}

TEST_F(ScanIntegratorTest, ABeamLeavesWhatItPassesAbove) {
  map.set({3, 0}, {0, 200});
  integrate({hit_beam(9.5, 0.5, 0.4)});
  EXPECT_EQ(map.cell({3, 0}), (Cell{0, 200}));
}

TEST_F(ScanIntegratorTest, TheBeamsHeightIsThatInTheMiddleOfItsStayInTheCell) {
  // From 0.4 m at x = 0.5 down to 0 at x = 8.5: at the middle of cell 4 it is 0.2 m high.
  map.set({4, 0}, {199, 200});
  integrate({hit_beam(8.5, 0.5, 0.0)});
  EXPECT_EQ(map.cell({4, 0}).probability, 200);
  map.set({4, 0}, {201 + kModel.tolerance_mm, 200});
  integrate({hit_beam(8.5, 0.5, 0.0)});
  EXPECT_EQ(map.cell({4, 0}).probability, combine(200, kModel.miss_probability));
}

TEST_F(ScanIntegratorTest, ABeamWithoutReturnWeakensAllButItsLastCell) {
  map.set({3, 0}, {1000, 200});
  map.set({6, 0}, {1000, 200});
  const ScanEffect effect = integrate({free_beam(6.5, 0.5, 0.4)});
  EXPECT_LT(map.cell({3, 0}).probability, 200);
  EXPECT_EQ(map.cell({6, 0}).probability, 200);
  EXPECT_THAT(effect.changed, ElementsAre(CellIndex{3, 0}));
}

TEST_F(ScanIntegratorTest, SeenThroughAgainAndAgainAPassedObstacleBecomesUnknown) {
  map.set({3, 0}, {1000, 250});
  for (int i = 0; i < 20; ++i) integrate({free_beam(6.5, 0.5, 0.4)});
  EXPECT_FALSE(map.cell({3, 0}).known());
}

TEST_F(ScanIntegratorTest, ABeamThatGrazesAWallDoesNotEraseIt) {
  // One beam hits the wall's cell (3, 0) at 1 m; later ones pass through the same cell below.
  map.set({3, 0}, {1000, 200});
  std::vector<Beam> beams{hit_beam(3.9, 0.9, 1.0)};
  for (int i = 0; i < 50; ++i) beams.push_back(hit_beam(9.5, 0.5, 0.4));
  integrate(beams);
  EXPECT_EQ(map.cell({3, 0}), (Cell{1000, combine(200, kModel.hit_probability)}));
}

TEST_F(ScanIntegratorTest, SparingLastsForOneScanOnly) {
  integrate({hit_beam(3.5, 0.5, 1.0)});
  integrate({hit_beam(9.5, 0.5, 0.4)});
  EXPECT_EQ(map.cell({3, 0}).probability, combine(kModel.hit_probability, kModel.miss_probability));
}

TEST_F(ScanIntegratorTest, DistinctHitsLeaveTheSameMapInWhateverOrderTheBeamsCome) {
  const std::vector<Beam> beams{hit_beam(3.5, 0.5, 0.9), hit_beam(9.5, 0.5, 0.4),
                                hit_beam(5.5, 3.5, 0.1), free_beam(7.5, 7.5, 0.2)};
  integrate(beams);
  HeightMap other(kCellMm);
  ScanIntegrator second(kModel);
  second.integrate(other, {beams.rbegin(), beams.rend()}, std::nullopt, nullptr);
  for (std::int32_t x = 0; x < 10; ++x) EXPECT_EQ(map.cell({x, 0}), other.cell({x, 0}));
}

TEST_F(ScanIntegratorTest, ChangedNamesEachCellOnceAndOnlyThoseThatDiffer) {
  map.set({5, 0}, {1000, kModel.max_probability});
  const ScanEffect effect =
      integrate({hit_beam(5.5, 0.5, 1.0), hit_beam(2.5, 0.5, 0.0), hit_beam(2.6, 0.5, 0.0)});
  EXPECT_THAT(effect.changed, ElementsAre(CellIndex{2, 0}));
}

TEST_F(ScanIntegratorTest, ChangedNamesCellsWestAndSouthOfTheOrigin) {
  const ScanEffect effect = integrate({hit_beam(-64.5, -0.5, 0.0)});
  EXPECT_THAT(effect.changed, ElementsAre(CellIndex{-65, -1}));
}

TEST_F(ScanIntegratorTest, SkipsBeamsThatAreNotFiniteOrLeaveTheExtent) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  Beam bad_origin = hit_beam(1.5, 0.5, 0);
  bad_origin.origin_m.y() = nan;
  const ScanEffect effect =
      integrate({hit_beam(nan, 0, 0), hit_beam(0, infinite, 0), hit_beam(1.5, 0.5, nan),
                 hit_beam(HeightMap::kMaxExtentM, 0, 0), hit_beam(1.5, 0.5, 2e5), bad_origin});
  EXPECT_EQ(effect.beams, 0);
  EXPECT_THAT(effect.changed, IsEmpty());
  EXPECT_TRUE(map.tiles().empty());
}

TEST_F(ScanIntegratorTest, CountsHitsTooFarFromTheirTilesDatum) {
  integrate({hit_beam(5.5, 0.5, 500.0)});
  const ScanEffect effect = integrate({hit_beam(6.5, 0.5, 0.0)});
  EXPECT_EQ(effect.unrepresentable, 1);
  EXPECT_FALSE(map.cell({6, 0}).known());
}

TEST_F(ScanIntegratorTest, PassingMakesNoTiles) {
  integrate({free_beam(500.5, 0.5, 0.4)});
  EXPECT_TRUE(map.tiles().empty());
}

TEST_F(ScanIntegratorTest, WithAGroundTheFreePartIsGroundAndTheHitAnObstacle) {
  const ScanEffect effect = integrator.integrate(map, {hit_beam(3.5, 0.5, 0.4)}, -20, nullptr);
  for (std::int32_t x = 0; x < 3; ++x) {
    EXPECT_EQ(map.cell({x, 0}), (Cell{-20, kModel.hit_probability}));
  }
  EXPECT_EQ(map.cell({3, 0}), (Cell{400, kModel.hit_probability}));
  EXPECT_EQ(effect.changed.size(), 4U);
}

TEST_F(ScanIntegratorTest, WithAGroundARemovedObstacleBecomesGroundAgain) {
  map.set({2, 0}, {1000, 250});
  for (int i = 0; i < 20; ++i) integrator.integrate(map, {hit_beam(5.5, 0.5, 0.4)}, 0, nullptr);
  EXPECT_EQ(map.cell({2, 0}).height_mm, 0);
  EXPECT_TRUE(map.cell({2, 0}).known());
}

TEST_F(ScanIntegratorTest, ReportsWhereABeamPassesBelowTheReference) {
  reference.set({3, 0}, {1000, 200});
  reference.set({4, 0}, {399, 200});
  const ScanEffect effect =
      integrator.integrate(map, {hit_beam(9.5, 0.5, 0.4)}, std::nullopt, &reference);
  ASSERT_EQ(effect.contradictions.size(), 1U);
  EXPECT_EQ(effect.contradictions[0].cell, (CellIndex{3, 0}));
  EXPECT_EQ(effect.contradictions[0].height_mm, 400);
  EXPECT_EQ(reference.cell({3, 0}), (Cell{1000, 200})) << "the reference is only read";
}

TEST_F(ScanIntegratorTest, ABeamAtTheHeightOfAThingSpeaksWeaklyAgainstItIfItGoesOn) {
  map.set({3, 0}, {400, 200});
  map.set({8, 0}, {400, 200});
  reference.set({5, 0}, {400 + kModel.tolerance_mm, 200});
  const ScanEffect effect =
      integrator.integrate(map, {hit_beam(9.1, 0.5, 0.4)}, std::nullopt, &reference);
  EXPECT_EQ(map.cell({3, 0}), (Cell{400, combine(200, kModel.graze_probability)}));
  EXPECT_EQ(map.cell({8, 0}), (Cell{400, combine(200, kModel.graze_probability)}));
  ASSERT_EQ(effect.contradictions.size(), 1U);
  EXPECT_TRUE(effect.contradictions[0].grazing);
  EXPECT_EQ(effect.contradictions[0].height_mm, 400 - kModel.tolerance_mm - 1);
}

TEST_F(ScanIntegratorTest, ABeamThatEndsRightBehindAThingGrazedIt) {
  map.set({8, 0}, {400, 200});
  integrate({{{8.2, 0.5, 0.4}, {9.05, 0.5, 0.4}, true}});
  EXPECT_EQ(map.cell({8, 0}), (Cell{400, 200}));
}

TEST_F(ScanIntegratorTest, ReportsEachCellOnceWithItsLowestBeam) {
  reference.set({3, 0}, {1000, 200});
  const ScanEffect effect = integrator.integrate(
      map, {hit_beam(9.5, 0.5, 0.4), hit_beam(6.5, 0.5, 0.1), hit_beam(9.5, 0.6, 0.5)},
      std::nullopt, &reference);
  ASSERT_EQ(effect.contradictions.size(), 1U);
  EXPECT_EQ(effect.contradictions[0].height_mm, 250);
}

TEST_F(ScanIntegratorTest, AHitInTheCellOrABeamEndingThereContradictsNothing) {
  reference.set({3, 0}, {1000, 200});
  reference.set({9, 0}, {1000, 200});
  const ScanEffect effect = integrator.integrate(
      map, {hit_beam(3.5, 0.2, 1.0), hit_beam(9.5, 0.5, 0.4)}, std::nullopt, &reference);
  EXPECT_THAT(effect.contradictions, IsEmpty());
}

/// The same rules, cell by cell, with nothing cached.
void integrate_plainly(HeightMap& map, const std::vector<Beam>& beams, const CellRules& rules) {
  std::map<std::pair<int, int>, bool> hit;
  const auto cell_of = [&](const Eigen::Vector3d& p) { return map.cell_at(p.x(), p.y()); };
  const auto mm = [](double m) { return static_cast<std::int32_t>(std::floor(m * 1000 + 0.5)); };
  for (const Beam& beam : beams) {
    const CellIndex c = cell_of(beam.end_m);
    if (beam.hit) hit[{c.x, c.y}] = true;
  }
  for (const Beam& beam : beams) {
    const double length_m = (beam.end_m - beam.origin_m).head<2>().norm();
    walk_cells(beam.origin_m.x(), beam.origin_m.y(), beam.end_m.x(), beam.end_m.y(),
               map.cell_size_m(), [&](CellIndex c, double t) {
                 if (c == cell_of(beam.end_m) || hit.contains({c.x, c.y})) return;
                 const double z = beam.origin_m.z() + t * (beam.end_m.z() - beam.origin_m.z());
                 const bool went_on = (1.0 - t) * length_m >= rules.model().graze_beyond_m;
                 map.set(c,
                         rules.after_pass(map.cell(c), rules.pass_of(map.cell(c), mm(z), went_on)));
               });
  }
  for (const Beam& beam : beams) {
    const CellIndex c = cell_of(beam.end_m);
    if (beam.hit) map.set(c, rules.after_hit(map.cell(c), mm(beam.end_m.z())));
  }
}

TEST_F(ScanIntegratorTest, AgreesWithThePlainRulesOnRandomScans) {
  const unsigned seed = std::random_device{}();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> metres(-120.0, 120.0);
  std::uniform_real_distribution<double> height(-1.0, 1.5);
  HeightMap plain(kCellMm);
  for (int scan = 0; scan < 50; ++scan) {
    std::vector<Beam> beams;
    const Eigen::Vector3d origin(metres(random), metres(random), height(random));
    for (int i = 0; i < 60; ++i) {
      beams.push_back({origin, {metres(random), metres(random), height(random)}, i % 5 != 0});
    }
    const HeightMap before = map;
    const ScanEffect effect = integrate(beams);
    integrate_plainly(plain, beams, CellRules(kModel));
    for (std::int32_t x = -121; x <= 121; ++x) {
      for (std::int32_t y = -121; y <= 121; ++y) {
        const Cell expected = plain.cell({x, y});
        ASSERT_EQ(map.cell({x, y}).probability, expected.probability) << "seed " << seed;
        if (!expected.known()) continue;
        ASSERT_EQ(map.cell({x, y}), expected) << "seed " << seed;
      }
    }
    for (const CellIndex c : effect.changed) ASSERT_NE(map.cell(c), before.cell(c));
  }
}

}  // namespace
}  // namespace cairn
