#include "proto/sync/evidence_sender.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "proto/sync/patch_receiver.h"

namespace cairn::proto {
namespace {

class EvidenceSenderTest : public ::testing::Test {
 protected:
  void see(CellIndex cell, int height_mm = 100) {
    ASSERT_TRUE(sender.open_submap()->surface.set(cell, {height_mm, 200}));
    sender.touch(EvidenceLayer::surface, {cell});
  }
  std::vector<Record> fill(std::uint32_t number) {
    last_number = number;
    FrameWriter writer({Direction::up, 1, number});
    const int added = sender.fill(writer, number);
    auto frame = decode_frame(std::move(writer).finish(), Direction::up);
    EXPECT_EQ(frame->records.size(), static_cast<std::size_t>(added));
    return std::move(frame->records);
  }
  /// What the patches of a frame tell.
  std::vector<BlockUpdate> blocks(const std::vector<Record>& records) {
    std::vector<BlockUpdate> all;
    for (const auto& record : records) {
      const auto* patch = std::get_if<EvidencePatch>(&record);
      if (patch == nullptr) continue;
      const auto read = patches.read(last_number, *patch);
      EXPECT_EQ(read.outcome, PatchReceiver::Outcome::read);
      all.insert(all.end(), read.blocks.begin(), read.blocks.end());
    }
    return all;
  }
  /// The first (and only) block of a frame.
  BlockUpdate block(const std::vector<Record>& records) {
    const auto all = blocks(records);
    EXPECT_EQ(all.size(), 1U);
    return all.empty() ? BlockUpdate{} : all[0];
  }
  static int heads(const std::vector<Record>& records) {
    return static_cast<int>(std::ranges::count_if(
        records, [](const auto& r) { return std::holds_alternative<SubmapHead>(r); }));
  }

  EvidenceSender sender;
  PatchReceiver patches;
  std::uint32_t last_number = 0;
};

TEST_F(EvidenceSenderTest, ANewSubmapIsItsHeadThenItsBlocks) {
  sender.begin(7, {1, 2, 3, 4}, 125);
  EXPECT_FALSE(sender.has_news());
  EXPECT_TRUE(sender.synchronised());
  see({0, 0});
  see({20, 0});
  const auto records = fill(1);
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(std::get<SubmapHead>(records[0]), (SubmapHead{1, 1, {1, 2, 3, 4}, false, 0, 0}));
  const auto told = blocks(records);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0].key.block, 0);
  EXPECT_EQ(told[1].key.block, 1);
  EXPECT_FALSE(sender.has_news());
  EXPECT_EQ(sender.backlog_blocks(), 2U);
  EXPECT_FALSE(sender.synchronised());
  sender.on_acked(1);
  EXPECT_TRUE(sender.synchronised());
  EXPECT_EQ(sender.backlog_blocks(), 0U);
}

TEST_F(EvidenceSenderTest, ASubmapOfWhichNothingWasToldNeverWas) {
  sender.begin(7, {}, 125);
  EXPECT_TRUE(fill(1).empty());
  sender.discard();
  EXPECT_EQ(sender.open_submap(), nullptr);
  EXPECT_EQ(sender.submaps(), 0U);
  EXPECT_EQ(sender.begin(7, {}, 125).id.sequence, 1U);
}

TEST_F(EvidenceSenderTest, SaysUpToWhichSubmapAllIsHeld) {
  EXPECT_EQ(sender.held_up_to(), 0U);
  sender.begin(7, {}, 125);
  see({0, 0});
  sender.close();
  sender.begin(7, {}, 125);
  see({0, 0});
  EXPECT_EQ(sender.held_up_to(), 0U);
  (void)fill(1);
  sender.on_acked(1);
  EXPECT_EQ(sender.held_up_to(), 1U);
  sender.close();
  (void)fill(2);
  sender.on_acked(2);
  EXPECT_EQ(sender.held_up_to(), 2U);
}

TEST_F(EvidenceSenderTest, IntermediateStatesAreSkipped) {
  sender.begin(7, {}, 125);
  for (int height = 1; height <= 50; ++height) see({3, 3}, height);
  const auto update = block(fill(1));
  EXPECT_EQ(update.base, 0U);
  EXPECT_EQ(update.version, 1U);
  EXPECT_EQ(update.delta.changed.count(), 1U);
  EXPECT_EQ(update.delta.cells.at(3 * 16 + 3).height_mm, 50);
}

TEST_F(EvidenceSenderTest, OnlyWhatChangedSinceTheAcknowledgedVersionTravels) {
  sender.begin(7, {}, 125);
  see({0, 0});
  (void)fill(1);
  sender.on_acked(1);
  see({1, 0});
  const auto update = block(fill(2));
  EXPECT_EQ(update.base, 1U);
  EXPECT_EQ(update.version, 2U);
  EXPECT_FALSE(update.delta.changed[0]);
  EXPECT_TRUE(update.delta.changed[1]);
}

TEST_F(EvidenceSenderTest, ABlockUnderWayWaitsForItsFate) {
  sender.begin(7, {}, 125);
  see({0, 0});
  (void)fill(1);
  see({1, 0});
  EXPECT_FALSE(sender.has_news());
  sender.on_lost(1);
  const auto update = block(fill(2));
  EXPECT_EQ(update.base, 0U);
  EXPECT_EQ(update.version, 2U) << "what is sent again is the newest";
  EXPECT_EQ(update.delta.changed.count(), 2U);
}

TEST_F(EvidenceSenderTest, ALateAcknowledgementOfALostFrameCounts) {
  sender.begin(7, {}, 125);
  see({0, 0});
  (void)fill(1);
  sender.on_lost(1);
  sender.on_acked(1);
  EXPECT_TRUE(sender.synchronised());
  EXPECT_TRUE(fill(2).empty());
}

TEST_F(EvidenceSenderTest, BlocksCarryTheirHeadUntilItIsKnown) {
  sender.begin(7, {}, 125);
  see({0, 0});
  EXPECT_EQ(heads(fill(1)), 1);
  see({40, 0});
  EXPECT_EQ(heads(fill(2)), 1);
  sender.on_acked(2);
  see({60, 60});
  EXPECT_EQ(heads(fill(3)), 0);
}

TEST_F(EvidenceSenderTest, TheOldestSubmapGoesFirst) {
  sender.begin(7, {}, 125);
  for (int i = 0; i < 64 * 40; ++i) see({i % 64, i / 64}, i * 7919 % 3000);
  sender.close();
  sender.begin(7, {}, 125);
  see({0, 0});
  std::uint32_t last = 1;
  for (std::uint32_t number = 1; sender.has_news(); ++number) {
    for (const BlockUpdate& update : blocks(fill(number))) {
      EXPECT_GE(update.sequence, last);
      last = update.sequence;
    }
  }
  EXPECT_EQ(last, 2U);
}

TEST_F(EvidenceSenderTest, ARoundSendsEachBlockOnceAndTheNextOneWhatChangedMeanwhile) {
  sender.begin(7, {}, 125);
  see({0, 0});
  sender.begin_round(0);
  EXPECT_EQ(block(fill(1)).version, 1U);
  EXPECT_FALSE(sender.round_has_news());
  sender.on_acked(1);
  see({1, 0});
  see({20, 0});
  EXPECT_TRUE(sender.has_news());
  ASSERT_TRUE(sender.round_has_news()) << "the block at (20, 0) has never been sent";
  EXPECT_EQ(block(fill(2)).key.block, 1);
  EXPECT_FALSE(sender.round_has_news());
  EXPECT_TRUE(fill(3).empty());
  sender.begin_round(3);
  EXPECT_TRUE(sender.round_has_news());
  EXPECT_EQ(block(fill(4)).version, 2U);
}

TEST_F(EvidenceSenderTest, WhatIsLostDoesNotWaitForTheNextRound) {
  sender.begin(7, {}, 125);
  see({0, 0});
  EXPECT_EQ(block(fill(1)).version, 1U);
  sender.on_acked(1);
  see({0, 0}, 300);
  sender.begin_round(1);
  (void)fill(2);
  EXPECT_FALSE(sender.round_has_news());
  sender.on_lost(2);
  EXPECT_TRUE(sender.round_has_news());
  EXPECT_EQ(block(fill(3)).version, 2U);
  EXPECT_FALSE(sender.round_has_news());
}

TEST_F(EvidenceSenderTest, WhatChangedNearTheRobotGoesFirst) {
  sender.begin(7, {}, 125);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) see({x, y}, (x * 7919 + y * 104'729) % 3000);
  }
  sender.set_view({{56, 56}, 0});
  const auto all = blocks(fill(1));
  ASSERT_FALSE(all.empty());
  ASSERT_LT(all.size(), 16U) << "the frame is too long to tell";
  EXPECT_TRUE(std::ranges::any_of(all, [](const auto& update) { return update.key.block == 15; }));
  EXPECT_FALSE(std::ranges::any_of(all, [](const auto& update) { return update.key.block == 0; }));
}

TEST_F(EvidenceSenderTest, TheLeastRecentlySentBlockGoesFirst) {
  sender.begin(7, {}, 125);
  see({0, 0});
  (void)fill(1);
  sender.on_acked(1);
  see({0, 0}, 5);
  for (int i = 0; i < 8; ++i) see({16 + i, i}, i * i * 7919 % 30'000);
  for (int i = 0; i < 8; ++i) see({i, i}, i * i * 5077 % 30'000);
  FrameWriter frame({Direction::up, 1, 2});  // With room for one of them.
  while (frame.room_bytes() > 210) ASSERT_TRUE(frame.add(PoseReport{}));
  const std::string rest(frame.room_bytes() - 17 - 58, 'a');
  ASSERT_TRUE(frame.add(CommandReport{1, 0, CommandState::blocked, rest}));
  ASSERT_EQ(sender.fill(frame, 2), 1);
  last_number = 2;
  EXPECT_EQ(block(decode_frame(std::move(frame).finish(), Direction::up)->records).key.block, 1);
}

TEST_F(EvidenceSenderTest, AClosedSubmapTellsItsSumsAndIsForgottenWhenHeld) {
  Submap& submap = sender.begin(7, {}, 125);
  see({0, 0});
  see({0, 0}, 7);
  ASSERT_TRUE(submap.seen_through.set({0, 0}, {-50, 9}));
  sender.touch(EvidenceLayer::seen_through, {{0, 0}});
  sender.close();
  EXPECT_EQ(sender.open_submap(), nullptr);
  const auto records = fill(1);
  EXPECT_EQ(std::get<SubmapHead>(records.at(0)), (SubmapHead{1, 2, {}, true, 2, 2}));
  EXPECT_EQ(sender.submaps(), 1U);
  sender.on_acked(1);
  EXPECT_EQ(sender.submaps(), 0U);
  EXPECT_EQ(sender.begin(7, {}, 125).id.sequence, 2U);
}

TEST_F(EvidenceSenderTest, ARefusalSendsFromWhatIsHeld) {
  sender.begin(7, {}, 125);
  see({0, 0});
  (void)fill(1);
  sender.on_acked(1);
  see({1, 0});
  const auto key = block(fill(2)).key;
  sender.on_refused({1, key, 0});
  const auto update = block(fill(3));
  EXPECT_EQ(update.base, 0U);
  EXPECT_EQ(update.delta.changed.count(), 2U);
}

TEST_F(EvidenceSenderTest, ARefusalCannotStandForAnAcknowledgement) {
  sender.begin(7, {}, 125);
  see({0, 0});
  const auto key = block(fill(1)).key;
  sender.on_refused({1, key, 1});
  sender.on_refused({9, key, 0});
  sender.on_lost(1);
  EXPECT_EQ(block(fill(2)).version, 1U);
}

TEST_F(EvidenceSenderTest, ANewSessionSendsAgainWhatWasUnderWayAndAnotherStoreEverything) {
  sender.begin(7, {}, 125);
  see({0, 0});
  (void)fill(1);
  sender.on_acked(1);
  see({40, 0});
  (void)fill(2);
  sender.on_session(false);
  patches = {};
  EXPECT_EQ(fill(1).size(), 1U);
  sender.on_session(true);
  patches = {};
  EXPECT_EQ(blocks(fill(1)).size(), 2U);
}

TEST_F(EvidenceSenderTest, AtItsBoundTheOldestClosedSubmapIsDroppedAndCounted) {
  for (std::size_t i = 0; i <= EvidenceSender::kMaxSubmaps; ++i) {
    sender.begin(7, {}, 125);
    sender.close();
  }
  EXPECT_EQ(sender.submaps(), EvidenceSender::kMaxSubmaps);
  EXPECT_EQ(sender.dropped_submaps(), 1U);
  EXPECT_EQ(std::get<SubmapHead>(fill(1).at(0)).sequence, 2U);
}

// ---- Copies outside -----------------------------------------------------------------------------

TEST_F(EvidenceSenderTest, ACopyThatIsTakenUpIsTheSame) {
  sender.begin(7, {1, 2, 3, 4}, 125).link = SubmapLink{{5, 6, 7, 8}, 1, 2, 3};
  see({0, 0});
  see({20, 0});
  fill(1);
  see({0, 0}, 300);
  const auto copy = sender.copy_of({7, 1});
  ASSERT_TRUE(copy);
  EvidenceSender later;
  ASSERT_TRUE(later.adopt(*copy, 8, 125));
  const auto again = later.copy_of({7, 1});
  ASSERT_TRUE(again);
  EXPECT_EQ(again->T_site_submap, copy->T_site_submap);
  EXPECT_EQ(again->link, copy->link);
  ASSERT_EQ(again->blocks.size(), 2U);
  EXPECT_EQ(again->blocks[0].version, 2U);
  EXPECT_EQ(again->blocks[0].delta.cells[0], (Cell{300, 200}));
  EXPECT_EQ(again->blocks[1].version, 1U);
}

TEST_F(EvidenceSenderTest, WhatWasTakenUpIsNamedInEverySessionAndClosedLast) {
  sender.begin(7, {}, 125);
  see({0, 0});
  const auto copy = *sender.copy_of({7, 1});
  EvidenceSender later;
  ASSERT_TRUE(later.adopt(copy, 8, 125));
  for (std::uint32_t number = 1; number <= 2; ++number) {  // In two sessions.
    later.on_session(false);
    FrameWriter frame({Direction::up, 1, number});
    ASSERT_EQ(later.fill(frame, number), 2);
    const auto records = decode_frame(std::move(frame).finish(), Direction::up)->records;
    const auto& head = std::get<SubmapHead>(records[0]);
    EXPECT_EQ(head.earlier, (SubmapId{7, 1}));
    EXPECT_GE(head.sequence, kFirstBorrowedSequence);
    EXPECT_FALSE(head.closed);
  }
  later.on_acked(2);
  FrameWriter frame({Direction::up, 1, 3});
  ASSERT_EQ(later.fill(frame, 3), 1);
  const auto records = decode_frame(std::move(frame).finish(), Direction::up)->records;
  const auto& head = std::get<SubmapHead>(records[0]);
  EXPECT_TRUE(head.closed);
  EXPECT_EQ(head.blocks, 0U);
  EXPECT_EQ(head.version, EvidenceSender::kAdoptedCloses);
  later.on_acked(3);
  EXPECT_EQ(later.submaps(), 0U);
  const auto gone = later.take_departures();
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_EQ(gone[0].id, (SubmapId{7, 1}));
  EXPECT_TRUE(gone[0].held);
}

TEST_F(EvidenceSenderTest, AnotherStoreOpensWhatWasTakenUpAgain) {
  sender.begin(7, {}, 125);
  see({0, 0});
  EvidenceSender later;
  ASSERT_TRUE(later.adopt(*sender.copy_of({7, 1}), 8, 125));
  FrameWriter frame({Direction::up, 1, 1});
  later.fill(frame, 1);
  later.on_acked(1);
  later.on_session(true);
  FrameWriter again({Direction::up, 2, 1});
  ASSERT_EQ(later.fill(again, 1), 2);
  const auto records = decode_frame(std::move(again).finish(), Direction::up)->records;
  EXPECT_FALSE(std::get<SubmapHead>(records[0]).closed);
}

TEST_F(EvidenceSenderTest, TakesUpNothingTwiceAndNothingThatContradictsItself) {
  sender.begin(7, {}, 125);
  see({0, 0});
  auto copy = *sender.copy_of({7, 1});
  EXPECT_FALSE(sender.adopt(copy, 7, 125));
  EvidenceSender later;
  auto doubled = copy;
  doubled.blocks.push_back(doubled.blocks[0]);
  EXPECT_FALSE(later.adopt(doubled, 8, 125));
  EXPECT_TRUE(later.adopt(copy, 8, 125));
  EXPECT_FALSE(later.adopt(copy, 8, 125));
  copy.id.sequence = 9;  // Of this boot, and not begun yet.
  EXPECT_FALSE(later.adopt(copy, 7, 125));
}

TEST_F(EvidenceSenderTest, FramesOfBeforeDoNotConfuseASubmapThatIsTakenUpWithLess) {
  sender.begin(7, {}, 125);
  see({0, 0});
  see({20, 0});
  auto copy = *sender.copy_of({7, 1});
  sender.close();
  fill(1);
  fill(2);
  for (std::size_t i = 0; i < EvidenceSender::kMaxSubmaps; ++i) {
    sender.begin(7, {}, 125);
    sender.close();
  }
  ASSERT_EQ(sender.dropped_submaps(), 1U);
  EvidenceSender& same = sender;
  copy.blocks.pop_back();
  while (same.submaps() == EvidenceSender::kMaxSubmaps) {
    fill(++last_number);
    same.on_acked(last_number);
  }
  ASSERT_TRUE(same.adopt(copy, 7, 125));
  same.on_lost(2);
  same.on_acked(1);
  EXPECT_EQ(same.backlog_blocks(), 0U);  // The block that is left was acknowledged by then.
}

}  // namespace
}  // namespace cairn::proto
