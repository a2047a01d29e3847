#include "robot_agent/drive/track.h"

#include <gtest/gtest.h>

namespace cairn::agent {
namespace {

TEST(Track, LeadsBackTheWayItCame) {
  Track track;
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(0, 0), {1, 0}, {1, 0.1}, {1, 1}}) {
    track.add(place);
  }
  const auto back = track.back_from({2, 1});
  ASSERT_EQ(back.size(), 4U) << "places that lie close together are one";
  EXPECT_EQ(back.front(), Eigen::Vector2d(2, 1));
  EXPECT_EQ(back[1], Eigen::Vector2d(1, 1));
  EXPECT_EQ(back.back(), Eigen::Vector2d(0, 0));
}

TEST(Track, StaysBoundedAndKeepsItsBeginning) {
  Track track;
  for (int i = 0; i < 100'000; ++i) track.add({0.3 * i, 0.0});
  const auto back = track.back_from({30'000, 0});
  EXPECT_LE(back.size(), Track::kMaxPoints + 1);
  EXPECT_GT(back.size(), Track::kMaxPoints / 4);
  EXPECT_EQ(back.back(), Eigen::Vector2d(0, 0));
}

TEST(Track, WithoutAWayLeadsNowhere) { EXPECT_EQ(Track().back_from({1, 2}).size(), 1U); }

}  // namespace
}  // namespace cairn::agent
