#include "core/delta/context_image.h"

#include <algorithm>

namespace cairn {

void ContextImage::merge(std::uint32_t sequence, const BlockKey& key, std::uint32_t base,
                         std::uint32_t version, const BlockDelta& delta, std::uint8_t tick) {
  const Block* held = find(sequence, key);
  const std::uint32_t held_version = held == nullptr ? 0 : held->version;
  if (held_version < base || held_version >= version) return;
  Block& block = make(sequence, key);
  block.version = version;
  block.datum_mm = delta.datum_mm;
  block.tick = tick;
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    if (!delta.changed[i]) continue;
    block.cells.at(i) = after_change(block.cells.at(i), delta.cells.at(i), tick);
  }
}

const ContextImage::Block* ContextImage::find(std::uint32_t sequence, const BlockKey& key) const {
  const auto submap = submaps_.find(sequence);
  if (submap == submaps_.end()) return nullptr;
  const auto block = submap->second.find(key);
  return block == submap->second.end() ? nullptr : block->second.get();
}

ContextImage::Block& ContextImage::make(std::uint32_t sequence, const BlockKey& key) {
  if (!submaps_.contains(sequence) && submaps_.size() == kMaxSubmaps) forget_oldest();
  if (find(sequence, key) == nullptr && blocks_ == kMaxBlocks) forget_oldest();
  std::unique_ptr<Block>& block = submaps_[sequence][key];
  if (block == nullptr) {
    block = std::make_unique<Block>();
    ++blocks_;
  }
  return *block;
}

void ContextImage::forget_oldest() {
  blocks_ -= submaps_.begin()->second.size();
  submaps_.erase(submaps_.begin());
}

void ContextImage::clear() {
  submaps_.clear();
  blocks_ = 0;
}

ContextImage::Cell after_change(const ContextImage::Cell& before, const Cell& now,
                                std::uint8_t tick) {
  if (!now.known()) return {.height_mm = 0, .probability = 0, .tick = tick, .updates = 0};
  const int updates = before.probability == 0 ? 1 : std::min(before.updates + 1, 255);
  return {now.height_mm, now.probability, tick, static_cast<std::uint8_t>(updates)};
}

}  // namespace cairn
