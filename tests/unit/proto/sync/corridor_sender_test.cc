#include "proto/sync/corridor_sender.h"

#include <gtest/gtest.h>

namespace cairn::proto {
namespace {

CorridorPart part(int first) {
  CorridorPart p;
  p.command = 9;
  p.first = static_cast<std::uint16_t>(first);
  p.directions.assign(kMaxCorridorBytes, 1);
  return p;
}

std::vector<std::uint16_t> fill(CorridorSender& sender, std::uint32_t number) {
  FrameWriter writer({Direction::down, 1, number});
  sender.fill(writer, number);
  std::vector<std::uint16_t> firsts;
  const auto frame = decode_frame(std::move(writer).finish(), Direction::down);
  for (const Record& record : frame->records) {
    firsts.push_back(std::get<CorridorPart>(record).first);
  }
  return firsts;
}

TEST(CorridorSender, SendsTheNearestFirstAsManyAsAFrameHolds) {
  CorridorSender sender;
  for (const int first : {0, 8, 16}) sender.add(part(first));
  EXPECT_EQ(fill(sender, 1), std::vector<std::uint16_t>{0});
  EXPECT_EQ(fill(sender, 2), std::vector<std::uint16_t>{8});
  EXPECT_EQ(fill(sender, 3), std::vector<std::uint16_t>{16});
  EXPECT_FALSE(sender.has_news());
}

TEST(CorridorSender, SendsOnlyWhatWasLostAgain) {
  CorridorSender sender;
  sender.add(part(0));
  sender.add(part(8));
  (void)fill(sender, 1);
  (void)fill(sender, 2);
  sender.on_acked(2);
  sender.on_lost(1);
  EXPECT_EQ(fill(sender, 3), std::vector<std::uint16_t>{0});
  sender.on_acked(3);
  sender.on_lost(3);
  EXPECT_FALSE(sender.has_news());
}

TEST(CorridorSender, HoldsABoundedNumberUntilTheyAreAcknowledged) {
  CorridorSender sender;
  for (int i = 0; i < 100; ++i) sender.add(part(i));
  std::uint32_t number = 1;
  while (sender.has_news()) (void)fill(sender, number++);
  EXPECT_EQ(number - 1, CorridorSender::kMaxParts);
  sender.on_acked(1);
  sender.add(part(200));
  EXPECT_EQ(fill(sender, number), std::vector<std::uint16_t>{200});
}

TEST(CorridorSender, AnotherOrderEndsIt) {
  CorridorSender sender;
  sender.add(part(0));
  sender.clear();
  EXPECT_FALSE(sender.has_news());
}

}  // namespace
}  // namespace cairn::proto
