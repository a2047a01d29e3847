#include <gtest/gtest.h>

#include "tests/unit/server/world/world_fixture.h"

/// Evidence that an earlier run of the agent left, delivered by a later one.
namespace cairn::server {
namespace {

constexpr std::uint64_t kEarlier = 1;
constexpr std::uint64_t kLater = 2;

class EarlierBootTest : public WorldTest {
 protected:
  void begin_session(proto::EvidenceSender& sender) {
    sender.on_session(false);
    link = std::make_unique<proto::ServerLink>(++session_, proto::Hello{"rover-1", "yard", kLater},
                                               9, 28, MonotonicTime{});
    number_ = 0;
  }
  /// One frame of evidence becomes durable and, unless its acknowledgement is `lost`, known to be.
  bool send_frame(proto::EvidenceSender& sender, bool lost = false) {
    proto::FrameWriter writer({proto::Direction::up, session_, ++number_});
    if (sender.fill(writer, number_) == 0) return false;
    const auto frame = proto::decode_frame(std::move(writer).finish(), proto::Direction::up);
    EXPECT_TRUE(frame);
    for (const auto& event : link->on_frame(*frame, 100, MonotonicTime{})) {
      const auto* evidence = std::get_if<Evidence>(&event);
      if (evidence == nullptr) continue;
      const auto staged = world->stage("rover-1", kLater, *evidence);
      EXPECT_TRUE(staged.accepted && staged.refusals.empty());
      commit_and_publish();
      if (!lost) sender.on_acked(number_);
    }
    return true;
  }
  void deliver_all(proto::EvidenceSender& sender) {
    while (sender.has_news() && send_frame(sender)) {
    }
  }

  std::unique_ptr<proto::ServerLink> link;

 private:
  std::uint32_t session_ = 0;
  std::uint32_t number_ = 0;
};

TEST_F(EarlierBootTest, CompletesASubmapOfWhichTheServerHoldsMoreThanWasKept) {
  Surveyor earlier(kEarlier);
  earlier.begin();
  earlier.see({0, 0}, 40, kFloor);
  deliver(earlier);
  const auto kept = *earlier.evidence.copy_of({kEarlier, 1});
  earlier.see({100, 0}, 8, kFloor);  // Sent, and not written down before the end.
  deliver(earlier);

  proto::EvidenceSender later;
  ASSERT_TRUE(later.adopt(kept, kLater, 125));
  begin_session(later);
  deliver_all(later);
  EXPECT_TRUE(later.synchronised());
  EXPECT_EQ(later.submaps(), 0U);
  EXPECT_EQ(world->merged_in_order(), (std::vector<SubmapId>{{kEarlier, 1}}));
  EXPECT_EQ(cell({20, 20}), kFloor);
  EXPECT_EQ(cell({104, 4}), kFloor);
  EXPECT_TRUE(is_sound());
}

TEST_F(EarlierBootTest, CompletesASubmapOfWhichTheServerHoldsLess) {
  Surveyor earlier(kEarlier);
  earlier.begin();
  earlier.see({0, 0}, 20, kFloor);
  deliver(earlier);
  earlier.see({0, 0}, 60, {50, 210});
  const auto kept = *earlier.evidence.copy_of({kEarlier, 1});

  proto::EvidenceSender later;
  ASSERT_TRUE(later.adopt(kept, kLater, 125));
  begin_session(later);
  deliver_all(later);
  EXPECT_EQ(world->merged(), 1U);
  EXPECT_EQ(cell({5, 5}), (Cell{50, 210}));
  EXPECT_EQ(cell({55, 55}), (Cell{50, 210}));
  EXPECT_TRUE(is_sound());
}

TEST_F(EarlierBootTest, WhatIsPartOfTheMapAlreadyIsNotAddedAgain) {
  Surveyor earlier(kEarlier);
  earlier.survey({0, 0}, 0);
  const auto kept = *earlier.evidence.copy_of({kEarlier, 1});
  deliver(earlier);
  const auto before = world->snapshot();

  proto::EvidenceSender later;
  ASSERT_TRUE(later.adopt(kept, kLater, 125));
  begin_session(later);
  deliver_all(later);
  EXPECT_EQ(later.submaps(), 0U);
  EXPECT_EQ(world->merged(), 1U);
  EXPECT_TRUE(same_tiles(*before, *world->snapshot()));
}

TEST_F(EarlierBootTest, GoesOnInAnotherSessionAfterTheServerCrashed) {
  Surveyor earlier(kEarlier);
  earlier.begin();
  std::mt19937_64 random(3);
  for (int i = 0; i < 60; ++i) earlier.scribble(random, {i * 10, 0});
  earlier.close();
  proto::EvidenceSender later;
  ASSERT_TRUE(later.adopt(*earlier.evidence.copy_of({kEarlier, 1}), kLater, 125));
  begin_session(later);
  ASSERT_TRUE(send_frame(later));
  ASSERT_TRUE(send_frame(later, true));
  ASSERT_EQ(world->merged(), 0U);
  restart();
  begin_session(later);
  deliver_all(later);
  EXPECT_EQ(world->merged(), 1U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of(earlier.closed)));
  EXPECT_TRUE(is_sound());
}

TEST_F(EarlierBootTest, StandsBesideWhatTheLaterRunMaps) {
  Surveyor earlier(kEarlier);
  earlier.survey({0, 0}, 0);
  Surveyor later(kLater);
  later.survey({100, 0}, 0);
  ASSERT_TRUE(later.evidence.adopt(*earlier.evidence.copy_of({kEarlier, 1}), kLater, 125));
  begin_session(later.evidence);
  deliver_all(later.evidence);
  EXPECT_EQ(world->merged(), 2U);
  EXPECT_TRUE(shows(*world->snapshot(), fold_of({earlier.closed[0], later.closed[0]})));
  EXPECT_TRUE(is_sound());
}

}  // namespace
}  // namespace cairn::server
