#include "proto/sync/order_desk.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace cairn::proto {
namespace {

Command command(std::uint64_t id, std::uint32_t revision, std::uint16_t bytes) {
  Command c;
  c.id = id;
  c.revision = revision;
  c.path_bytes = bytes;
  return c;
}

PathPart part(std::uint64_t id, std::uint32_t revision, std::uint8_t index, std::size_t bytes) {
  return {id, revision, index, std::vector<std::uint8_t>(bytes, index)};
}

CorridorPart corridor(std::uint64_t id, std::uint32_t revision) {
  CorridorPart c;
  c.command = id;
  c.revision = revision;
  c.directions = {1};
  return c;
}

TEST(OrderDesk, ACommandWithoutAPathIsCompleteAtOnceAndHandedOutOnce) {
  OrderDesk desk;
  EXPECT_TRUE(desk.on_command(command(1, 0, 0)).order);
  const auto again = desk.on_command(command(1, 0, 0));
  EXPECT_FALSE(again.order);
  EXPECT_EQ(again.asked_again, (OrderDesk::Key{1, 0}));
}

TEST(OrderDesk, PartsMayComeInAnyOrderAndTwice) {
  OrderDesk desk;
  EXPECT_FALSE(desk.on_part(part(1, 0, 1, 500)).order);
  EXPECT_FALSE(desk.on_command(command(1, 0, 1500)).order);
  EXPECT_FALSE(desk.on_part(part(1, 0, 1, 500)).order);
  const auto outcome = desk.on_part(part(1, 0, 0, kPartBytes));
  ASSERT_TRUE(outcome.order);
  std::vector<std::uint8_t> path(1500, 0);
  std::fill(path.begin() + kPartBytes, path.end(), 1);
  EXPECT_EQ(outcome.order->path, path);
  EXPECT_FALSE(desk.on_part(part(1, 0, 0, kPartBytes)).order);
}

TEST(OrderDesk, ANewRevisionReplacesAnUnfinishedOne) {
  OrderDesk desk;
  (void)desk.on_command(command(1, 0, 20));
  EXPECT_FALSE(desk.on_command(command(1, 1, 10)).order);
  EXPECT_FALSE(desk.on_part(part(1, 0, 0, 20)).order) << "parts of the old path do not count";
  EXPECT_TRUE(desk.on_part(part(1, 1, 0, 10)).order);
}

TEST(OrderDesk, ACorridorThatComesBeforeItsOrderWaitsForIt) {
  OrderDesk desk;
  desk.on_corridor(corridor(4, 2));
  EXPECT_TRUE(desk.take_corridors().empty());
  (void)desk.on_command(command(4, 2, 10));
  EXPECT_TRUE(desk.take_corridors().empty());
  (void)desk.on_part(part(4, 2, 0, 10));
  EXPECT_EQ(desk.take_corridors().size(), 1U);
  desk.on_corridor(corridor(4, 2));
  EXPECT_EQ(desk.take_corridors().size(), 1U);
  EXPECT_TRUE(desk.take_corridors().empty());
}

TEST(OrderDesk, CorridorsOfOlderOrdersAreForgottenAndTheirNumberIsBounded) {
  OrderDesk desk;
  for (int i = 0; i < 100; ++i) desk.on_corridor(corridor(4, 2));
  desk.on_corridor(corridor(4, 1));
  (void)desk.on_command(command(4, 2, 0));
  EXPECT_EQ(desk.take_corridors().size(), OrderDesk::kMaxCorridors);
  desk.on_corridor(corridor(4, 2));
  (void)desk.on_command(command(4, 3, 0));
  EXPECT_TRUE(desk.take_corridors().empty());
}

TEST(OrderDesk, OlderCommandsAreSupersededAndOlderRevisionsIgnored) {
  OrderDesk desk;
  (void)desk.on_command(command(5, 2, 0));
  EXPECT_EQ(desk.on_command(command(4, 9, 0)).superseded, (OrderDesk::Key{4, 9}));
  const auto old_revision = desk.on_command(command(5, 1, 0));
  EXPECT_FALSE(old_revision.order || old_revision.superseded || old_revision.asked_again);
}

TEST(OrderDesk, AnotherStoreMayCountFromOneAgain) {
  OrderDesk desk;
  (void)desk.on_command(command(5, 0, 0));
  desk.forget();
  EXPECT_TRUE(desk.on_command(command(1, 0, 0)).order);
}

}  // namespace
}  // namespace cairn::proto
