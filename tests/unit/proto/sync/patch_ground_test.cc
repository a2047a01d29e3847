#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "proto/sync/patch_receiver.h"
#include "proto/sync/patch_sender.h"
#include "tests/support/sample_records.h"

/// The common ground of patches, kept by PatchSender and PatchReceiver over a bad link.
namespace cairn::proto {
namespace {

using Outcome = PatchReceiver::Outcome;

class PatchGround : public ::testing::Test {
 protected:
  struct Frame {
    std::uint32_t number = 0;
    std::vector<EvidencePatch> patches;
    std::vector<BlockUpdate> told;
  };

  /// New values in a few blocks, in a frame of their own.
  Frame send() {
    Frame frame{.number = ++number, .patches = {}, .told = {}};
    for (int block = 0; block < 4; ++block) frame.told.push_back(changes(block));
    FrameWriter writer({Direction::up, 1, frame.number});
    EXPECT_EQ(sender.fill(writer, frame.number, frame.told, std::nullopt).size(), 4U);
    const auto decoded = decode_frame(std::move(writer).finish(), Direction::up);
    for (const Record& record : decoded->records) {
      frame.patches.push_back(std::get<EvidencePatch>(record));
    }
    return frame;
  }
  Outcome receive(const Frame& frame) {
    const auto read = receiver.read(frame.number, frame.patches.at(0));
    if (read.outcome != Outcome::read) return read.outcome;
    EXPECT_EQ(read.blocks.size(), frame.told.size());
    for (std::size_t i = 0; i < read.blocks.size(); ++i) {
      EXPECT_TRUE(testing::same(read.blocks[i], frame.told[i])) << "frame " << frame.number;
    }
    return Outcome::read;
  }
  static std::size_t size(const Frame& frame) { return frame.patches.at(0).bytes.size(); }

  PatchSender sender;
  PatchReceiver receiver;
  std::uint32_t number = 0;
  std::mt19937_64 random{1};

 private:
  BlockUpdate changes(int block) {
    const std::uint32_t version = ++versions_[static_cast<std::size_t>(block)];
    const BlockKey key{EvidenceLayer::surface, {0, 0, 0}, static_cast<std::uint8_t>(block)};
    BlockUpdate update{1, key, version - 1, version, {}};
    for (std::size_t i = 0; i < kBlockCells; i += 2 + random() % 3) {
      update.delta.changed.set(i);
      update.delta.cells.at(i) = coarse({static_cast<int>(2 * i + random() % 30), 200}, {}, {});
    }
    return update;
  }

  std::array<std::uint32_t, 4> versions_{};
};

TEST_F(PatchGround, WhatWasAcknowledgedMakesTheNextPatchShorter) {
  std::size_t first = 0;
  std::size_t later = 0;
  for (int round = 0; round < 12; ++round) {
    sender.begin_round(number);
    const Frame frame = send();
    ASSERT_EQ(receive(frame), Outcome::read);
    sender.on_acked(frame.number);
    (round == 0 ? first : later) = size(frame);
  }
  EXPECT_LT(later, first);
}

TEST_F(PatchGround, LossDuplicationAndDelayOfFramesAndAcksAreFollowed) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    random.seed(seed);
    sender = {};
    receiver = {};
    number = 0;
    std::vector<Frame> under_way;
    std::vector<std::uint32_t> acks;
    int read = 0;
    for (int round = 0; round < 60; ++round) {
      sender.begin_round(number);
      for (std::uint64_t i = 0; i <= random() % 3; ++i) under_way.push_back(send());
      for (std::size_t i = 0; i < under_way.size();) {
        const auto fate = random() % 10;
        if (fate < 3) {  // Still under way: later ones overtake it.
          ++i;
          continue;
        }
        const Frame frame = under_way[i];
        under_way.erase(under_way.begin() + static_cast<std::ptrdiff_t>(i));
        if (fate < 5) continue;  // Lost.
        const Outcome outcome = receive(frame);
        ASSERT_NE(outcome, Outcome::lost) << "frame " << frame.number;
        if (outcome != Outcome::read) continue;
        ++read;
        acks.push_back(frame.number);
      }
      std::shuffle(acks.begin(), acks.end(), random);
      while (!acks.empty() && random() % 3 != 0) {
        if (random() % 5 != 0) sender.on_acked(acks.back());
        acks.pop_back();
      }
    }
    EXPECT_GT(read, 30);
  }
}

TEST_F(PatchGround, AnOvertakenFrameOfAnEarlierRoundIsLate) {
  const Frame first = send();
  ASSERT_EQ(receive(first), Outcome::read);
  const Frame overtaken = send();
  sender.on_acked(first.number);
  sender.begin_round(number);
  ASSERT_EQ(receive(send()), Outcome::read);
  EXPECT_EQ(receive(overtaken), Outcome::late);
}

TEST_F(PatchGround, AReceiverThatLostItAsksForAFreshOne) {
  const Frame first = send();
  ASSERT_EQ(receive(first), Outcome::read);
  sender.on_acked(first.number);
  sender.begin_round(number);
  receiver = {};
  const Frame second = send();
  ASSERT_EQ(receive(second), Outcome::lost);
  sender.on_ground_lost(second.patches.at(0).ground.epoch);
  const Frame third = send();
  EXPECT_EQ(third.patches.at(0).ground.epoch, 1);
  EXPECT_EQ(receive(third), Outcome::read);
  sender.on_ground_lost(0);  // An old complaint.
  EXPECT_EQ(send().patches.at(0).ground.epoch, 1);
  EXPECT_EQ(receive(second), Outcome::late);
}

TEST_F(PatchGround, AfterALongPauseTheRobotBeginsAnewByItself) {
  const Frame first = send();
  ASSERT_EQ(receive(first), Outcome::read);
  sender.on_acked(first.number);
  sender.begin_round(number);
  ASSERT_EQ(receive(send()), Outcome::read);  // Names the first; its acknowledgement is lost.
  number += 1000;                             // Poses.
  sender.begin_round(number);
  const Frame late = send();
  EXPECT_EQ(late.patches.at(0).ground.epoch, 1);
  EXPECT_EQ(receive(late), Outcome::read);
}

TEST_F(PatchGround, ANewSessionBeginsWithNothingAtBothEnds) {
  const Frame first = send();
  ASSERT_EQ(receive(first), Outcome::read);
  sender.on_acked(first.number);
  sender.begin_round(number);
  sender.on_session();
  receiver = {};
  number = 0;
  const Frame again = send();
  EXPECT_EQ(again.patches.at(0).ground, CommonGround{});
  EXPECT_EQ(receive(again), Outcome::read);
}

TEST_F(PatchGround, NonsenseIsRefusedWhateverItIs) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    random.seed(seed);
    EvidencePatch patch;
    patch.ground.epoch = static_cast<std::uint8_t>(random() % 4);
    patch.ground.before = static_cast<std::uint8_t>(random() % 3);
    patch.ground.back.resize(random() % 4);
    for (auto& back : patch.ground.back) back = static_cast<std::uint8_t>(1 + random() % 3);
    patch.bytes.resize(1 + random() % 60);
    for (auto& byte : patch.bytes) byte = static_cast<std::uint8_t>(random());
    (void)receiver.read(static_cast<std::uint32_t>(random() % 8), patch);
  }
}

}  // namespace
}  // namespace cairn::proto
