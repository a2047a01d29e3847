#include "robot_agent/pipeline/news.h"

#include <gtest/gtest.h>

#include "core/map/submap.h"

namespace cairn::agent {
namespace {

constexpr Cell kUnknown{};
constexpr Cell kSureFloor{0, 250};
constexpr Cell kSureBox{400, 250};
constexpr std::int32_t kGroundMm = 0;

class WhatIsNews : public ::testing::Test {
 protected:
  [[nodiscard]] News::Worth worth(const Cell& known, const Cell& seen, const Cell& surface) const {
    return news_.worth(known, news_.folded(known, seen, surface), surface, kGroundMm);
  }
  const SensorModel model_;
  const News news_{{}, model_};
};

TEST_F(WhatIsNews, NothingIsNone) {
  EXPECT_EQ(worth(kSureFloor, kUnknown, kUnknown), News::Worth::nothing);
  EXPECT_EQ(worth(kUnknown, kUnknown, kUnknown), News::Worth::nothing);
}

TEST_F(WhatIsNews, HitsOnASureSurfaceAreNone) {
  EXPECT_EQ(worth(kSureFloor, kUnknown, {0, 250}), News::Worth::nothing);
  EXPECT_EQ(worth(kSureFloor, kUnknown, {15, 250}), News::Worth::nothing);
}

TEST_F(WhatIsNews, AFloorThatLiesElsewhereIsLittle) {
  EXPECT_EQ(worth(kSureFloor, kUnknown, {48, 250}), News::Worth::little);
}

TEST_F(WhatIsNews, HitsOnADoubtfulSurfaceAreLittle) {
  EXPECT_EQ(worth({0, 140}, kUnknown, {0, 250}), News::Worth::little);
}

TEST_F(WhatIsNews, SomethingNewIsMuchOnceItWasHitMoreThanOnce) {
  EXPECT_EQ(worth(kSureFloor, kUnknown, {400, 166}), News::Worth::nothing);
  EXPECT_EQ(worth(kSureFloor, kUnknown, {400, 221}), News::Worth::much);
}

TEST_F(WhatIsNews, WhatIsSeenForTheFirstTimeIsLittle) {
  EXPECT_EQ(worth(kUnknown, kUnknown, {0, 166}), News::Worth::nothing);
  EXPECT_EQ(worth(kUnknown, kUnknown, {0, 221}), News::Worth::little);
}

TEST_F(WhatIsNews, AGrazedEdgeIsNone) {
  EXPECT_EQ(worth(kSureBox, {300, 200}, kUnknown), News::Worth::nothing);
}

TEST_F(WhatIsNews, SomethingThatWasSeenThroughIsNews) {
  EXPECT_NE(worth(kSureBox, {0, 250}, kUnknown), News::Worth::nothing);
  EXPECT_NE(worth(kSureBox, {0, 250}, {0, 250}), News::Worth::nothing);
  EXPECT_NE(worth(kSureBox, {0, kCertainlyEmpty}, kUnknown), News::Worth::nothing);
}

TEST_F(WhatIsNews, SomethingThatWasSeenThroughAndStillStandsIsNone) {
  EXPECT_EQ(worth(kSureBox, {0, 250}, {400, 250}), News::Worth::nothing);
}

TEST_F(WhatIsNews, AStandingThingsOtherHeightsAreNoneUnlessTheyAreFarOff) {
  EXPECT_EQ(worth(kSureBox, {250, 250}, {270, 250}), News::Worth::nothing);
  EXPECT_EQ(worth(kSureBox, kUnknown, {700, 250}), News::Worth::nothing);
  EXPECT_EQ(worth(kSureBox, kUnknown, {900, 250}), News::Worth::much);
}

TEST_F(WhatIsNews, AThingThatSankToTheGroundIs) {
  EXPECT_EQ(worth(kSureBox, {60, 250}, {100, 250}), News::Worth::little);
}

}  // namespace
}  // namespace cairn::agent
