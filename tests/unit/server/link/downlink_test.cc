#include "server/link/downlink.h"

#include <gtest/gtest.h>

namespace cairn::server {
namespace {

using std::chrono::seconds;

class DownlinkTest : public ::testing::Test {
 protected:
  static constexpr TileKey kTile{0, 1, 2};
  static proto::MapDigest digest(bool last) {
    proto::MapDigest digest;
    digest.last = last;
    return digest;
  }
  proto::ServerLink link{1, {"rover", "lab", 7, 125, 0}, 1, 28, seconds(1)};
  Downlink downlink;
  MonotonicTime now = seconds(1);
};

TEST_F(DownlinkTest, WaitsForTheRobotsFirstWordButNotForEver) {
  EXPECT_FALSE(downlink.should_ask(link, now));
  EXPECT_FALSE(downlink.should_ask(link, now + Downlink::kFirstWord - seconds(1)));
  EXPECT_TRUE(downlink.should_ask(link, now + Downlink::kFirstWord));
}

TEST_F(DownlinkTest, AsksOnceAllThatTheRobotHoldsIsCompared) {
  EXPECT_FALSE(downlink.should_ask(link, now));
  downlink.hear(digest(false), now);
  downlink.take(std::vector<ComparedTile>{});
  EXPECT_FALSE(downlink.should_ask(link, now + Downlink::kFirstWord));
  downlink.hear(digest(true), now);
  EXPECT_FALSE(downlink.should_ask(link, now));
  downlink.take({{kTile, true, 5}});
  EXPECT_TRUE(downlink.should_ask(link, now));
  EXPECT_EQ(downlink.told()->stamps.at(kTile), 5U);
}

TEST_F(DownlinkTest, DoesNotWaitForTheLastWordForEver) {
  EXPECT_FALSE(downlink.should_ask(link, now));
  downlink.hear(digest(false), now);
  downlink.take(std::vector<ComparedTile>{});
  EXPECT_TRUE(downlink.should_ask(link, now + Downlink::kNextWord));
}

TEST_F(DownlinkTest, NotesATileThatDiffersAlthoughItWasTold) {
  downlink.hear(digest(false), now);
  downlink.take({{kTile, true, 5}});
  downlink.hear(digest(false), now);
  downlink.take({{kTile, false, 5}});
  EXPECT_TRUE(downlink.told()->differs.contains(kTile));
  downlink.hear(digest(false), now);
  downlink.take({{kTile, true, 5}});
  EXPECT_FALSE(downlink.told()->differs.contains(kTile));
}

TEST_F(DownlinkTest, ATileWithNewsIsToldAnyway) {
  downlink.hear(digest(false), now);
  downlink.take({{kTile, false, 5}});
  EXPECT_TRUE(downlink.told()->differs.empty());
  EXPECT_FALSE(downlink.told()->stamps.contains(kTile));
}

}  // namespace
}  // namespace cairn::server
