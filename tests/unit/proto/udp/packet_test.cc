#include "proto/udp/packet.h"

#include <gtest/gtest.h>

#include "proto/codec/frame.h"

namespace cairn::proto {
namespace {

UdpBytes frame_with(std::uint32_t session, const Record& record) {
  FrameWriter frame({.direction = Direction::up, .session = session, .number = 1});
  frame.add(record);
  return std::move(frame).finish();
}

TEST(UdpPacket, KeepsPayloadsWhole) {
  const auto first = decode_first_payload(encode(FirstPayload{7, 9, 5, {1, 2, 3}}));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->stamp, 7U);
  EXPECT_EQ(first->session, 9U);
  EXPECT_EQ(first->greeting, (UdpBytes{1, 2, 3}));
  const auto second = decode_second_payload(encode(SecondPayload{11, {4}}));
  ASSERT_TRUE(second);
  EXPECT_EQ(second->session, 11U);
  EXPECT_EQ(second->answer, UdpBytes{4});
  const auto stale = decode_stale(encode(Stale{5, 6, {8}}));
  ASSERT_TRUE(stale);
  EXPECT_EQ(stale->newest, 6U);
}

TEST(UdpPacket, RefusesPayloadsThatAreTooShort) {
  const UdpBytes first = encode(FirstPayload{7, 9, 5, {}});
  EXPECT_FALSE(decode_first_payload(std::span(first).first(first.size() - 1)));
  const UdpBytes second = encode(SecondPayload{11, {}});
  EXPECT_FALSE(decode_second_payload(std::span(second).first(second.size() - 1)));
  UdpBytes stale = encode(Stale{5, 6, {}});
  stale.push_back(0);
  EXPECT_FALSE(decode_stale(stale));
}

TEST(UdpPacket, HasBytesThatNeverChange) {
  EXPECT_EQ(first_head({1, 2, 3, 4, 5, 6, 7, 8}), (UdpBytes{1, 1, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(second_head(0x04030201), (UdpBytes{2, 1, 2, 3, 4}));
  EXPECT_EQ(unknown_packet(0x04030201), (UdpBytes{4, 1, 2, 3, 4}));
  EXPECT_EQ(data_head(0x04030201, 0xFF070605), (UdpBytes{5, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(encode(FirstPayload{2, 3, 4, {9}}),
            (UdpBytes{2, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 4, 0, 0, 0, 9}));
}

TEST(UdpPacket, CostsTwentyFourBytesAFrame) { EXPECT_EQ(kDataBytes, 24U); }

TEST(UdpPacket, KnowsAGreetingFromAFrameOfASession) {
  EXPECT_TRUE(is_greeting(frame_with(0, Hello{.robot = "r", .site = "s", .cell_size_mm = 100})));
  EXPECT_FALSE(is_greeting(frame_with(7, Bye{})));
  EXPECT_FALSE(is_greeting(UdpBytes(8)));
  EXPECT_FALSE(is_greeting(UdpBytes(kMaxFrameBytes + 1)));
}

TEST(UdpPacket, NamesNoSessionInWhatIsTooShort) {
  EXPECT_FALSE(named_session(UdpBytes{}));
  EXPECT_FALSE(named_session(UdpBytes{5, 1, 2, 3, 4}));
  EXPECT_FALSE(named_session(UdpBytes{9, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(named_session(unknown_packet(77)), 77U);
}

}  // namespace
}  // namespace cairn::proto
