#include "core/graph/faces.h"

#include <gtest/gtest.h>

#include <random>

#include "core/graph/footprint.h"
#include "tests/unit/core/localization/test_ground.h"

namespace cairn {
namespace {

HeightMap seen_from(const LevelPose& T_site_submap, unsigned seed) {
  std::mt19937_64 random(seed);
  return test::sampled_map(test::RichGround{}, upright(T_site_submap), {.half_cells = 36},
                           test::kCellMm, random);
}

TEST(Faces, MeetWhereTheSubmapsReallyLie) {
  const LevelPose a{1.0, 2.0, 0.0, 0.4};
  const LevelPose b{2.5, 0.5, 0.0, -0.3};
  const Faces from(seen_from(a, 1));
  const Faces to(seen_from(b, 2));
  const LevelPose believed = between(a, b) * LevelPose{0.6, -0.5, 0.0, 0.1};
  const auto places = lay_faces(to, from, believed, {0.0, 0.0}, 1.0, 0.2, 4);
  ASSERT_FALSE(places.empty());
  const Eigen::Vector4d off = difference(places.front().T_from_to, between(a, b));
  EXPECT_LT(off.head<2>().norm(), 0.13);
  EXPECT_LT(std::abs(off[3]), 0.03);
  EXPECT_GT(agreement(to, from, between(a, b)).share(), 0.8);
  const LevelPose wrong = between(a, b) * LevelPose{1.0, 0.7, 0.0, 0.3};
  EXPECT_LT(agreement(to, from, wrong).share(), agreement(to, from, between(a, b)).share() - 0.1);
}

TEST(Faces, OfFlatGroundThereAreNone) {
  std::mt19937_64 random(1);
  const Faces flat(test::short_term_of(test::FlatGround{}, Pose{}, random));
  EXPECT_TRUE(flat.points_m().empty());
  EXPECT_TRUE(lay_faces(flat, flat, {}, {0.0, 0.0}, 1.0, 0.2, 4).empty());
  EXPECT_TRUE(Faces(HeightMap(test::kCellMm)).points_m().empty());
}

TEST(Footprint, TellsHowMuchOfASubmapLiesOnAnother) {
  const HeightMap square = seen_from({}, 1);  // 9 × 9 m.
  const Footprint footprint(square);
  EXPECT_DOUBLE_EQ(footprint.overlap_on(footprint, {}), 1.0);
  EXPECT_NEAR(footprint.overlap_on(footprint, {4.5, 0.0, 0.0, 0.0}), 0.5, 0.1);
  EXPECT_EQ(footprint.overlap_on(footprint, {20.0, 0.0, 0.0, 0.0}), 0.0);
  EXPECT_TRUE(Footprint(HeightMap(test::kCellMm)).empty());
}

}  // namespace
}  // namespace cairn
