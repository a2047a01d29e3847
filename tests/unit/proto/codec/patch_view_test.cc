#include "proto/codec/patch_view.h"

#include <gtest/gtest.h>

#include <numbers>

namespace cairn::proto {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

TEST(Heading, IsTheNearestOfSixtyFour) {
  EXPECT_EQ(heading_of(0.0), 0);
  EXPECT_EQ(heading_of(kTurn / 4), 16);
  EXPECT_EQ(heading_of(-kTurn / 64), 63);
  EXPECT_EQ(heading_of(0.49 * kTurn / 64), 0);
  EXPECT_EQ(heading_of(-3.0 * kTurn), 0);
  EXPECT_EQ(heading_of(kTurn * (1.0 - 0.2 / 64)), 0);
}

TEST(Place, IsTheSameForEveryHeadingWhenTheCellTurnsAlong) {
  const patch::Place ahead = patch::place_from({{100, -50}, 0}, 100 + 30, -50 + 10);
  const patch::Place turned = patch::place_from({{100, -50}, 16}, 100 - 10, -50 + 30);
  EXPECT_EQ(ahead.distance, turned.distance);
  EXPECT_EQ(ahead.ahead, turned.ahead);
  EXPECT_EQ(ahead.aside, turned.aside);
  EXPECT_EQ(ahead.octant, turned.octant);
}

TEST(Place, TellsAheadFromAside) {
  const Viewpoint view{{0, 0}, 0};
  EXPECT_EQ(patch::place_from(view, 0, 0).ahead, 12U);
  EXPECT_EQ(patch::place_from(view, 40, 0).ahead, 22U);
  EXPECT_EQ(patch::place_from(view, 40, 0).aside, 0U);
  EXPECT_EQ(patch::place_from(view, 0, 40).aside, 5U);
  EXPECT_EQ(patch::place_from(view, 0, -40).aside, 5U);
  EXPECT_NE(patch::place_from(view, 1, 40).octant, patch::place_from(view, 1, -40).octant);
}

TEST(Place, StaysWithinItsClassesHoweverFar) {
  for (const std::int64_t far : {std::int64_t{1}, std::int64_t{5000}, std::int64_t{1} << 40}) {
    for (int heading = 0; heading < kHeadings; ++heading) {
      const Viewpoint view{{-(1 << 29), 1 << 29}, static_cast<std::uint8_t>(heading)};
      for (const auto& [x, y] : {std::pair{far, far}, {-far, far}, {far, -far}, {-far, -far}}) {
        const patch::Place place = patch::place_from(view, x, y);
        EXPECT_LT(place.polar(), patch::Place::kDistances * patch::Place::kOctants);
        EXPECT_LT(place.square(), patch::Place::kAhead * patch::Place::kAside);
      }
    }
  }
}

}  // namespace
}  // namespace cairn::proto
