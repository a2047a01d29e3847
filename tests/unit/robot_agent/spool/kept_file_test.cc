#include "robot_agent/spool/kept_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "proto/codec/frame.h"
#include "tests/unit/robot_agent/spool/samples.h"

namespace cairn::agent {
namespace {

using testing::kOwner;
using testing::same;
using testing::sample;

constexpr std::size_t kChecksumBytes = 4;

void mend_checksum(std::vector<std::uint8_t>& bytes) {
  const std::size_t end = bytes.size() - kChecksumBytes;
  const std::uint32_t crc = proto::crc32c(std::span(bytes).first(end));
  for (std::size_t i = 0; i < kChecksumBytes; ++i) {
    bytes[end + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  }
}

TEST(KeptFile, IsReadAsItWasWritten) {
  const auto kept = sample({0xABCDEF0123456789, 3}, 100);
  const auto read = read_kept(write_kept(kept, kOwner, {}), kOwner);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(same(*read, kept));
}

TEST(KeptFile, HoldsCellsThatBecameUnknownAgain) {
  auto kept = sample({7, 1}, 4);
  for (auto& block : kept.blocks) {
    for (std::size_t i = 0; i < kBlockCells; ++i) {
      if (block.delta.changed[i]) block.delta.cells.at(i) = {};
    }
  }
  const auto read = read_kept(write_kept(kept, kOwner, {}), kOwner);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->blocks.size(), kept.blocks.size());
  EXPECT_FALSE(read->blocks[0].delta.cells.at(0).known());
}

TEST(KeptFile, IsRefusedWithAnyOneByteWrong) {
  const auto bytes = write_kept(sample({7, 1}, 12), kOwner, {});
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto damaged = bytes;
    damaged[i] ^= 0x41U;
    EXPECT_FALSE(read_kept(damaged, kOwner)) << "byte " << i;
  }
}

TEST(KeptFile, IsRefusedWhenItEndsAnywhereEarlier) {
  const auto bytes = write_kept(sample({7, 1}, 12), kOwner, {});
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(read_kept(std::span(bytes).first(length), kOwner)) << length;
  }
}

TEST(KeptFile, OfNonsenseUnderARightChecksumDoesNoHarm) {
  const auto bytes = write_kept(sample({7, 1}, 12), kOwner, {});
  int refused = 0;
  for (std::size_t i = 0; i + kChecksumBytes < bytes.size(); ++i) {
    for (const unsigned flip : {0x01U, 0x80U, 0xFFU}) {
      auto damaged = bytes;
      damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ flip);
      mend_checksum(damaged);
      const auto read = read_kept(damaged, kOwner);
      proto::EvidenceSender sender;
      if (read) (void)sender.adopt(*read, 1, 125);
      refused += read ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(KeptFile, OfAnotherOwnerSaysHowToDeliverIt) {
  const auto bytes = write_kept(sample({7, 1}), {"r2", "yard", 250}, {});
  const auto read = read_kept(bytes, kOwner);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::conflict);
  EXPECT_NE(read.error().message.find("--robot r2 --site yard --cell-mm 250"), std::string::npos)
      << read.error().message;
}

TEST(KeptFile, OfAnotherVersionSaysSo) {
  auto bytes = write_kept(sample({7, 1}), kOwner, {});
  bytes[4] = 9;
  mend_checksum(bytes);
  const auto read = read_kept(bytes, kOwner);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::unsupported_version);
}

TEST(KeptFile, ThinnedHasOnlyItsSurface) {
  auto kept = sample({7, 1});
  const std::size_t blocks = kept.blocks.size();
  EXPECT_TRUE(thin(kept));
  EXPECT_EQ(kept.blocks.size(), blocks / 2);
  EXPECT_FALSE(thin(kept));
}

}  // namespace
}  // namespace cairn::agent
