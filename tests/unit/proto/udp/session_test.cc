#include "proto/udp/session.h"

#include <gtest/gtest.h>

namespace cairn::proto {
namespace {

struct Pair {
  Secret up = Secret::random();
  Secret down = Secret::random();
  UdpSession robot{1, 2, up, down};
  UdpSession server{2, 1, down, up};
};

TEST(UdpSession, CarriesFramesBothWays) {
  Pair ends;
  const auto up = ends.server.open(ends.robot.seal(UdpBytes{1, 2}));
  const auto down = ends.robot.open(ends.server.seal(UdpBytes{3}));
  ASSERT_TRUE(up && down);
  EXPECT_EQ(up->frame, (UdpBytes{1, 2}));
  EXPECT_EQ(down->frame, UdpBytes{3});
}

TEST(UdpSession, TakesReorderedPacketsAndEachOnce) {
  Pair ends;
  const UdpBytes a = ends.robot.seal(UdpBytes{1});
  const UdpBytes b = ends.robot.seal(UdpBytes{2});
  ASSERT_TRUE(ends.server.open(b));
  const auto late = ends.server.open(a);
  ASSERT_TRUE(late);
  EXPECT_FALSE(late->newest);
  EXPECT_FALSE(ends.server.open(a));
  EXPECT_FALSE(ends.server.open(b));
}

TEST(UdpSession, RefusesItsOwnPacketsThrownBackAtIt) {
  Pair ends;
  UdpBytes thrown = ends.robot.seal(UdpBytes{1});
  EXPECT_FALSE(ends.robot.open(thrown));
  std::ranges::copy(data_head(1, 0), thrown.begin());  // Even under the other name.
  EXPECT_FALSE(ends.robot.open(thrown));
}

TEST(UdpSession, RefusesEveryFlippedBitAndEveryTruncation) {
  Pair ends;
  const UdpBytes packet = ends.robot.seal(UdpBytes{1, 2, 3});
  for (std::size_t bit = 0; bit < packet.size() * 8; ++bit) {
    UdpBytes forged = packet;
    forged[bit / 8] = static_cast<std::uint8_t>(forged[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_FALSE(ends.server.open(forged)) << "bit " << bit;
  }
  for (std::size_t size = 0; size < packet.size(); ++size) {
    EXPECT_FALSE(ends.server.open(std::span(packet).first(size)));
  }
  EXPECT_TRUE(ends.server.open(packet)) << "forgeries must leave no trace";
}

TEST(UdpSession, GoesOnAfterALongSilentStretchOfSending) {
  Pair ends;
  for (int i = 0; i < 100'000; ++i) (void)ends.robot.seal({});
  EXPECT_TRUE(ends.server.open(ends.robot.seal(UdpBytes{1})));
}

}  // namespace
}  // namespace cairn::proto
