#include "proto/sync/order_desk.h"

#include <gtest/gtest.h>

namespace cairn::proto {
namespace {

Command command(std::uint64_t id, std::uint32_t revision, std::uint16_t points) {
  Command c;
  c.id = id;
  c.revision = revision;
  c.path_points = points;
  return c;
}

PathPart part(std::uint64_t id, std::uint32_t revision, std::uint16_t first, int points) {
  PathPart p{id, revision, first, {}};
  for (int i = 0; i < points; ++i) p.points.push_back({first + i, 0});
  return p;
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
  EXPECT_FALSE(desk.on_part(part(1, 0, 100, 50)).order);
  EXPECT_FALSE(desk.on_command(command(1, 0, 150)).order);
  EXPECT_FALSE(desk.on_part(part(1, 0, 100, 50)).order);
  const auto outcome = desk.on_part(part(1, 0, 0, 100));
  ASSERT_TRUE(outcome.order);
  ASSERT_EQ(outcome.order->path.size(), 150U);
  for (int i = 0; i < 150; ++i)
    EXPECT_EQ(outcome.order->path.at(static_cast<std::size_t>(i)).x_mm, i);
  EXPECT_FALSE(desk.on_part(part(1, 0, 0, 100)).order);
}

TEST(OrderDesk, ANewRevisionReplacesAnUnfinishedOne) {
  OrderDesk desk;
  (void)desk.on_command(command(1, 0, 20));
  EXPECT_FALSE(desk.on_command(command(1, 1, 10)).order);
  EXPECT_FALSE(desk.on_part(part(1, 0, 0, 20)).order) << "parts of the old path do not count";
  EXPECT_TRUE(desk.on_part(part(1, 1, 0, 10)).order);
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
