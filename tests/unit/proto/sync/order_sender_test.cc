#include "proto/sync/order_sender.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace cairn::proto {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Command command(std::uint64_t id) {
  Command c;
  c.id = id;
  return c;
}

struct Filled {
  bool command = false;
  std::vector<int> parts;
};

Filled fill(OrderSender& sender, std::uint32_t number, MonotonicTime now = {}) {
  FrameWriter writer({Direction::down, 1, number});
  sender.fill_command(writer, number, 0, now);
  sender.fill_parts(writer, number);
  Filled filled;
  const auto frame = decode_frame(std::move(writer).finish(), Direction::down);
  for (const auto& record : frame->records) {
    filled.command = filled.command || std::holds_alternative<Command>(record);
    if (const auto* part = std::get_if<PathPart>(&record)) filled.parts.push_back(part->part);
  }
  return filled;
}

TEST(OrderSender, ALongPathTakesAsManyFramesAsItNeeds) {
  OrderSender sender;
  sender.set(command(1), std::vector<std::uint8_t>(2500), seconds(10));
  std::vector<int> parts;
  for (std::uint32_t number = 1; sender.has_news(); ++number) {
    ASSERT_LE(number, 3U);
    const auto filled = fill(sender, number);
    EXPECT_EQ(filled.command, number == 1);
    parts.insert(parts.end(), filled.parts.begin(), filled.parts.end());
  }
  std::ranges::sort(parts);
  EXPECT_EQ(parts, (std::vector<int>{0, 1, 2}));
}

TEST(OrderSender, AShortPathTravelsInTheFrameOfItsRecord) {
  OrderSender sender;
  sender.set(command(1), std::vector<std::uint8_t>(OrderSender::kShortPath, 7), seconds(10));
  FrameWriter writer({Direction::down, 1, 1});
  EXPECT_TRUE(sender.fill_command(writer, 1, 0, {}));
  EXPECT_FALSE(sender.has_news());
  const auto frame = decode_frame(std::move(writer).finish(), Direction::down);
  ASSERT_EQ(frame->records.size(), 2U);
  EXPECT_EQ(std::get<Command>(frame->records[0]).path_bytes, OrderSender::kShortPath);
  EXPECT_EQ(std::get<PathPart>(frame->records[1]).bytes.size(), OrderSender::kShortPath);
}

TEST(OrderSender, OnlyWhatWasLostIsSentAgain) {
  OrderSender sender;
  sender.set(command(1), std::vector<std::uint8_t>(1500), seconds(10));
  const auto first = fill(sender, 1);
  const auto second = fill(sender, 2);
  EXPECT_FALSE(sender.has_news());
  sender.on_acked(1);
  sender.on_lost(2);
  const auto third = fill(sender, 3);
  EXPECT_FALSE(third.command);
  EXPECT_EQ(third.parts, second.parts);
}

TEST(OrderSender, ItAsksAgainEverLessOftenUntilTheRobotReports) {
  OrderSender sender;
  sender.set(command(1), {}, seconds(10));
  MonotonicTime now{};
  std::uint32_t number = 1;
  for (const int wait_s : {1, 2, 4, 8, 16, 30, 30}) {
    EXPECT_TRUE(fill(sender, number, now).command);
    sender.on_acked(number++);
    sender.ask_again_if_due(now + seconds(wait_s) - milliseconds(1));
    EXPECT_FALSE(sender.has_news());
    now += seconds(wait_s);
    sender.ask_again_if_due(now);
    EXPECT_TRUE(sender.has_news());
  }
  sender.on_report({2, 0, CommandState::accepted, ""});
  sender.on_report({1, 1, CommandState::accepted, ""});
  EXPECT_TRUE(sender.has_news()) << "those were reports on something else";
  sender.on_report({1, 0, CommandState::refused, "no"});
  EXPECT_FALSE(sender.has_news());
  EXPECT_FALSE(sender.ask_due());
}

TEST(OrderSender, ANewCommandReplacesTheOneBefore) {
  OrderSender sender;
  sender.set(command(1), std::vector<std::uint8_t>(1500), seconds(10));
  sender.set(command(2), {}, seconds(10));
  const auto filled = fill(sender, 1);
  EXPECT_TRUE(filled.command);
  EXPECT_TRUE(filled.parts.empty());
  EXPECT_FALSE(sender.has_news());
}

}  // namespace
}  // namespace cairn::proto
