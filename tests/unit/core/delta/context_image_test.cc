#include "core/delta/context_image.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

BlockKey key(int block) {
  return {EvidenceLayer::surface, {0, block / 16, 0}, static_cast<std::uint8_t>(block % 16)};
}

BlockDelta one_cell(std::size_t at, Cell cell) {
  BlockDelta delta;
  delta.datum_mm = 1000;
  delta.changed.set(at);
  delta.cells.at(at) = cell;
  return delta;
}

TEST(ContextImage, HoldsWhatWasMergedWithItsTimeAndCount) {
  ContextImage image;
  EXPECT_EQ(image.find(1, key(0)), nullptr);
  image.merge(1, told_block(key(0), 1, one_cell(7, {500, 200})), 40);
  image.merge(1, told_block(key(0), 4, one_cell(7, {510, 210})), 41);
  const auto* block = image.find(1, key(0));
  ASSERT_NE(block, nullptr);
  EXPECT_EQ(block->version, 4U);
  EXPECT_EQ(block->datum_mm, 1000);
  EXPECT_EQ(block->tick, 41);
  EXPECT_EQ(block->cells[7], (ContextImage::SeenCell{510, 210, 41, 2}));
  EXPECT_EQ(block->cells[8], ContextImage::SeenCell{});
}

TEST(ContextImage, TakesOnlyWhatIsNewerThanWhatItHolds) {
  ContextImage image;
  image.merge(1, told_block(key(0), 3, one_cell(0, {1, 1})), 1);
  image.merge(1, told_block(key(0), 3, one_cell(0, {3, 3})), 3);
  image.merge(1, told_block(key(0), 2, one_cell(0, {2, 2})), 3);
  EXPECT_EQ(image.find(1, key(0))->cells[0].height_mm, 1);
  image.merge(1, told_block(key(0), 5, one_cell(0, {4, 4})), 4);
  EXPECT_EQ(image.find(1, key(0))->cells[0].height_mm, 4);
}

TEST(ContextImage, ACellThatIsUnknownAgainBeginsAnew) {
  ContextImage image;
  image.merge(1, told_block(key(0), 1, one_cell(0, {9, 200})), 1);
  image.merge(1, told_block(key(0), 2, one_cell(0, {})), 2);
  EXPECT_EQ(image.find(1, key(0))->cells[0], (ContextImage::SeenCell{0, 0, 2, 0}));
}

TEST(ContextImage, ForgetsTheOldestSubmapsWhenThereAreTooMany) {
  ContextImage image;
  for (std::uint32_t submap = 1; submap <= ContextImage::kMaxSubmaps + 1; ++submap) {
    image.merge(submap, told_block(key(0), 1, one_cell(0, {1, 1})), 1);
  }
  EXPECT_EQ(image.find(1, key(0)), nullptr);
  EXPECT_NE(image.find(2, key(0)), nullptr);
  EXPECT_EQ(image.blocks(), ContextImage::kMaxSubmaps);
}

TEST(ContextImage, NeverHoldsMoreBlocksThanItsBound) {
  ContextImage image;
  for (int block = 0; block < 3 * static_cast<int>(ContextImage::kMaxBlocks); ++block) {
    image.merge(1, told_block(key(block), 1, one_cell(0, {1, 1})), 1);
    ASSERT_LE(image.blocks(), ContextImage::kMaxBlocks);
  }
  EXPECT_NE(image.find(1, key(3 * static_cast<int>(ContextImage::kMaxBlocks) - 1)), nullptr);
}

}  // namespace
}  // namespace cairn
