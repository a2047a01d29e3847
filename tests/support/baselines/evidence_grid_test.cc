#include <gtest/gtest.h>

#include "tests/support/baselines/evidence_grid_2d.h"
#include "tests/support/baselines/evidence_grid_3d.h"

namespace cairn::baselines {
namespace {

GridExtent ten_by_ten() { return {.width = 10, .height = 10, .cell_m = 1.0}; }

const Beam kHit{{0.5, 0.5, 0.42}, {3.5, 0.5, 0.42}, true};

template <class Update>
class EvidenceGrid2dTest : public testing::Test {};
using Updates = testing::Types<Bayes, Himm, DempsterShafer>;
TYPED_TEST_SUITE(EvidenceGrid2dTest, Updates);

TYPED_TEST(EvidenceGrid2dTest, WhatABeamHitsIsOccupiedAndWhatItPassedIsNot) {
  EvidenceGrid2d<TypeParam> grid(ten_by_ten());
  const double unseen = grid.occupied({5, 5});
  for (int i = 0; i < 20; ++i) grid.integrate(std::vector<Beam>{kHit});
  EXPECT_GT(grid.occupied({3, 0}), 0.9);
  for (std::int32_t x = 0; x < 3; ++x) EXPECT_LE(grid.occupied({x, 0}), 0.05);
  EXPECT_EQ(grid.occupied({4, 0}), unseen);
}

TYPED_TEST(EvidenceGrid2dTest, WithoutReturnNothingIsHit) {
  EvidenceGrid2d<TypeParam> grid(ten_by_ten());
  const double unseen = grid.occupied({3, 0});
  grid.integrate({{kHit.origin_m, kHit.end_m, false}});
  EXPECT_EQ(grid.occupied({3, 0}), unseen);
}

TYPED_TEST(EvidenceGrid2dTest, LeavesOutWhatLiesOutside) {
  EvidenceGrid2d<TypeParam> grid(ten_by_ten());
  grid.integrate({{{-5.5, 5.5, 0}, {15.5, 5.5, 0}, true}});
  EXPECT_LE(grid.occupied({9, 5}), 0.5);
}

TEST(EvidenceGrid3d, MarksTheVoxelThatWasHitAndEmptiesThoseBeforeIt) {
  EvidenceGrid3d grid(ten_by_ten(), 0);
  for (int i = 0; i < 20; ++i) grid.integrate(std::vector<Beam>{kHit});
  EXPECT_GT(grid.occupied({3, 0}, 8), 0.9);
  EXPECT_LT(grid.occupied({2, 0}, 8), 0.1);
  EXPECT_NEAR(grid.occupied({2, 0}, 7), 0.5, 0.01) << "the layer below was not seen";
}

TEST(EvidenceGrid3d, ASteepBeamCrossesEveryLayerOnItsWay) {
  EvidenceGrid3d grid(ten_by_ten(), 0);
  grid.integrate({{{0.5, 0.5, 0.98}, {0.6, 0.5, 0.02}, true}});
  for (int layer = 1; layer < EvidenceGrid3d::kLayers; ++layer) {
    EXPECT_LT(grid.occupied({0, 0}, layer), 0.5) << layer;
  }
  EXPECT_GT(grid.occupied({0, 0}, 0), 0.6);
}

TEST(EvidenceGrid3d, LosesWhatIsAboveItsMetre) {
  EvidenceGrid3d grid(ten_by_ten(), 0);
  grid.integrate({{{0.5, 0.5, 1.4}, {3.5, 0.5, 1.4}, true}});
  for (int layer = 0; layer < EvidenceGrid3d::kLayers; ++layer) {
    EXPECT_NEAR(grid.occupied({3, 0}, layer), 0.5, 0.01);
  }
}

TEST(EvidenceGrid3d, Takes20TimesTheRoomOfTheFlatOne) {
  EXPECT_EQ(EvidenceGrid3d({}, 0).bytes(), 327'680U);
  EXPECT_EQ(EvidenceGrid2d<Bayes>({}).bytes(), 16'384U);
}

}  // namespace
}  // namespace cairn::baselines
