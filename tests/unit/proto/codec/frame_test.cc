#include "proto/codec/frame.h"

#include <gtest/gtest.h>

#include <string_view>

#include "tests/support/random_records.h"
#include "tests/support/sample_records.h"

namespace cairn::proto {
namespace {

using testing::frame_of;
using testing::sample_records;
using Bytes = std::vector<std::uint8_t>;

Bytes signed_again(Bytes bytes) {
  bytes.resize(bytes.size() - kChecksumBytes);
  const std::uint32_t crc = crc32c(bytes);
  for (unsigned i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(crc >> (8 * i)));
  return bytes;
}

Direction direction_of(const Record& record) {
  for (const auto& sample : sample_records()) {
    if (sample.record.index() == record.index()) return sample.direction;
  }
  return Direction::up;
}

TEST(Frame, ChecksumIsCrc32c) {
  constexpr std::string_view kCheck = "123456789";
  EXPECT_EQ(crc32c(Bytes(kCheck.begin(), kCheck.end())), 0xE3069283U);
}

TEST(Frame, AnEmptyFrameIsItsHeaderAndChecksum) {
  const Bytes bytes = FrameWriter({Direction::down, 3, 4}).finish();
  ASSERT_EQ(bytes.size(), 16U);
  const auto frame = decode_frame(bytes, Direction::down);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->header, (FrameHeader{Direction::down, 3, 4}));
  EXPECT_TRUE(frame->records.empty());
}

TEST(Frame, EveryRecordComesBackAsItWasSent) {
  constexpr std::uint64_t kSeed = 2024;
  testing::RandomRecords random(kSeed);
  for (int i = 0; i < 5000; ++i) {
    const Record sent = random.any();
    const FrameHeader header{direction_of(sent), 7, static_cast<std::uint32_t>(i)};
    FrameWriter writer(header);
    ASSERT_TRUE(writer.add(sent));
    const auto got = decode_frame(std::move(writer).finish(), header.direction);
    ASSERT_TRUE(got) << "seed " << kSeed << " record " << i << ": " << got.error().message;
    ASSERT_EQ(got->header, header);
    ASSERT_EQ(got->records.size(), 1U);
    ASSERT_TRUE(testing::same(got->records[0], sent)) << "seed " << kSeed << " record " << i;
  }
}

TEST(Frame, RecordsKeepTheirOrder) {
  FrameWriter writer({Direction::up, 1, 1});
  for (std::uint32_t i = 0; i < 20; ++i) ASSERT_TRUE(writer.add(Ack{i, i}));
  const auto frame = decode_frame(std::move(writer).finish(), Direction::up);
  ASSERT_TRUE(frame);
  for (std::uint32_t i = 0; i < 20; ++i) EXPECT_EQ(std::get<Ack>(frame->records[i]).cumulative, i);
}

TEST(Frame, ARecordThatDoesNotFitChangesNothing) {
  FrameWriter writer({Direction::down, 1, 1});
  const PathPart part{1, 1, 0, std::vector<std::uint8_t>(kPartBytes)};
  ASSERT_TRUE(writer.add(part));
  const std::size_t before = writer.size_bytes();
  EXPECT_FALSE(writer.add(part));
  EXPECT_EQ(writer.size_bytes(), before);
  const auto frame = decode_frame(std::move(writer).finish(), Direction::down);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->records.size(), 1U);
}

TEST(Frame, NeitherEndTakesMoreRecordsThanTheBound) {
  FrameWriter writer({Direction::up, 1, 1});
  for (std::size_t i = 0; i < kMaxFrameRecords; ++i) ASSERT_TRUE(writer.add(Bye{}));
  EXPECT_FALSE(writer.add(Bye{}));
  Bytes bytes = std::move(writer).finish();
  EXPECT_TRUE(decode_frame(bytes, Direction::up));
  bytes.insert(bytes.end() - kChecksumBytes, {6, 0, 0});
  EXPECT_FALSE(decode_frame(signed_again(bytes), Direction::up));
}

TEST(Frame, TextsAreCutAndCleanedOnTheWayOut) {
  FrameWriter writer({Direction::up, 1, 1});
  ASSERT_TRUE(writer.add(CommandReport{1, 1, CommandState::refused, std::string(500, '\n')}));
  const auto frame = decode_frame(std::move(writer).finish(), Direction::up);
  ASSERT_TRUE(frame);
  EXPECT_EQ(std::get<CommandReport>(frame->records[0]).why, std::string(kMaxTextBytes, ' '));
}

TEST(Frame, EveryChangedByteIsNoticed) {
  for (const auto& sample : sample_records()) {
    const Bytes good = frame_of(sample);
    for (std::size_t at = 0; at < good.size(); ++at) {
      for (unsigned flip = 1; flip < 256; ++flip) {
        Bytes bad = good;
        bad[at] = static_cast<std::uint8_t>(bad[at] ^ flip);
        ASSERT_FALSE(decode_frame(bad, sample.direction)) << sample.name << " byte " << at;
      }
    }
  }
}

TEST(Frame, EveryCutIsNoticedEvenWithARightChecksum) {
  for (const auto& sample : sample_records()) {
    const Bytes good = frame_of(sample);
    for (std::size_t length = 0; length < good.size(); ++length) {
      const auto end = good.begin() + static_cast<std::ptrdiff_t>(length);
      ASSERT_FALSE(decode_frame(Bytes(good.begin(), end), sample.direction)) << sample.name;
    }
    for (std::size_t length = 17; length < good.size(); ++length) {
      const auto end = good.begin() + static_cast<std::ptrdiff_t>(length);
      ASSERT_FALSE(decode_frame(signed_again(Bytes(good.begin(), end)), sample.direction));
    }
  }
}

TEST(Frame, GarbageIsAnErrorNotACrash) {
  std::mt19937_64 random(99);
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes(random() % 120);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    ASSERT_FALSE(decode_frame(bytes, Direction::up));
  }
}

TEST(Frame, GarbageInsideAWellFormedFrameIsAFrameOrAnError) {
  std::mt19937_64 random(98);
  const auto samples = sample_records();
  for (int i = 0; i < 100'000; ++i) {
    const auto& sample = samples[random() % samples.size()];
    Bytes bytes = frame_of(sample);
    for (int hits = 0; hits < 3; ++hits) {
      const std::size_t at = kFrameHeaderBytes + random() % (bytes.size() - kFrameHeaderBytes);
      bytes[at] = static_cast<std::uint8_t>(random());
    }
    const auto frame = decode_frame(signed_again(bytes), sample.direction);
    if (frame) continue;
    ASSERT_NE(frame.error().message.find("malformed frame: "), std::string::npos);
  }
}

TEST(Frame, AnotherVersionIsNamedAsSuch) {
  Bytes bytes = FrameWriter({Direction::up, 1, 1}).finish();
  bytes[2] = kProtocolVersion + 1;
  const auto frame = decode_frame(signed_again(bytes), Direction::up);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, ErrorCode::unsupported_version);
}

TEST(Frame, OtherMagicAndTheWrongDirectionAreRefused) {
  const Bytes good = FrameWriter({Direction::up, 1, 1}).finish();
  EXPECT_FALSE(decode_frame(good, Direction::down));
  for (const std::size_t at : {0U, 1U}) {
    Bytes bad = good;
    bad[at] = 'X';
    EXPECT_FALSE(decode_frame(signed_again(bad), Direction::up));
  }
}

TEST(Frame, LongerThanAFrameMayBeIsRefused) {
  Bytes bytes = FrameWriter({Direction::up, 1, 1}).finish();
  bytes.resize(kMaxFrameBytes + 1);
  EXPECT_FALSE(decode_frame(signed_again(bytes), Direction::up));
}

TEST(BareFrame, IsTheFrameWithoutWhatItsCarrierKnows) {
  FrameWriter writer({.direction = Direction::up, .session = 7, .number = 9});
  writer.add(Bye{});
  const auto whole = std::move(writer).finish();
  const auto bare = bare_frame(whole, Direction::up);
  ASSERT_TRUE(bare);
  EXPECT_EQ(bare->size(), whole.size() - kFrameEndsBytes);
  EXPECT_EQ(whole_frame(*bare, Direction::up), whole);
}

TEST(BareFrame, IsNotMadeOfWhatMustBeRefusedOrTellsItsVersion) {
  FrameWriter greeting({.direction = Direction::up, .session = 0, .number = 1});
  greeting.add(Hello{"rover", "quarry", 7, 125, 0});
  EXPECT_FALSE(bare_frame(std::move(greeting).finish(), Direction::up));
  FrameWriter writer({.direction = Direction::up, .session = 7, .number = 9});
  writer.add(Bye{});
  auto frame = std::move(writer).finish();
  EXPECT_FALSE(bare_frame(frame, Direction::down));
  frame.back() ^= 1U;
  EXPECT_FALSE(bare_frame(frame, Direction::up));
}

}  // namespace
}  // namespace cairn::proto
