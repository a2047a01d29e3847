#include "server/api/outbox.h"

#include <gtest/gtest.h>

#include "fake_service.h"

namespace cairn::server {
namespace {

TEST(Outbox, SendsAnswersBeforeTheStatusBeforeTiles) {
  Outbox outbox;
  Service::Map map;
  map.tiles = {{{0, 0, 0}, full_tile(1)}, {{0, 1, 0}, full_tile(1)}};
  outbox.map(3, map);
  EXPECT_TRUE(outbox.next()->binary);
  outbox.status("status");
  outbox.answer("answer", true);
  EXPECT_EQ(outbox.next()->bytes, "answer");
  EXPECT_EQ(outbox.next()->bytes, "status");
  const auto last = outbox.next();
  EXPECT_TRUE(last->binary && last->ends_request);
  EXPECT_FALSE(outbox.next());
}

TEST(Outbox, KeepsOnlyTheNewestStatus) {
  Outbox outbox;
  outbox.status("old");
  outbox.status("new");
  EXPECT_EQ(outbox.next()->bytes, "new");
  EXPECT_FALSE(outbox.next());
}

}  // namespace
}  // namespace cairn::server
