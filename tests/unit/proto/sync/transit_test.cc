#include "proto/sync/transit.h"

#include <gtest/gtest.h>

namespace cairn::proto {
namespace {

TEST(Transit, WaitsUntilItIsSentAndAgainWhenItIsLost) {
  Transit record;
  EXPECT_TRUE(record.waits());
  record.sent(3);
  EXPECT_FALSE(record.waits());
  record.on_lost(2);
  EXPECT_FALSE(record.waits());
  record.on_lost(3);
  EXPECT_TRUE(record.waits());
}

TEST(Transit, IsAcknowledgedByAnyOfItsCopies) {
  Transit record;
  record.sent(3);
  record.on_lost(3);
  record.sent(5);
  record.on_acked(4);
  EXPECT_FALSE(record.acknowledged());
  record.on_acked(3);
  EXPECT_TRUE(record.acknowledged());
  record.on_lost(5);
  EXPECT_TRUE(record.acknowledged()) << "the peer has it";
}

TEST(Transit, AnEarlierCopyThatIsLostSaysNothingOfTheNewest) {
  Transit record;
  record.sent(3);
  record.on_lost(3);
  record.sent(5);
  record.on_lost(3);
  EXPECT_FALSE(record.waits());
}

TEST(Transit, WhatWasSaidBeforeItIsSaidAnewDoesNotCount) {
  Transit record;
  record.sent(3);
  record.again();
  EXPECT_TRUE(record.waits());
  record.sent(7);
  record.on_acked(3);
  EXPECT_FALSE(record.acknowledged());
}

}  // namespace
}  // namespace cairn::proto
