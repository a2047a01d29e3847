#include "core/delta/context_image.h"

#include <algorithm>

namespace cairn {

ToldBlock told_block(const BlockKey& key, std::uint32_t version, const BlockDelta& delta) {
  ToldBlock told{key, version, delta.datum_mm, {}};
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    if (delta.changed[i]) told.cells.emplace_back(static_cast<std::uint8_t>(i), delta.cells.at(i));
  }
  return told;
}

void ContextImage::merge(std::uint32_t sequence, const ToldBlock& told, std::uint8_t tick) {
  const Block* held = find(sequence, told.key);
  if (held != nullptr && held->version >= told.version) return;
  Block& block = make(sequence, told.key);
  block.version = told.version;
  block.datum_mm = told.datum_mm;
  block.tick = tick;
  for (const auto& [place, cell] : told.cells) {
    block.cells.at(place) = after_change(block.cells.at(place), cell, tick);
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

ContextImage::SeenCell after_change(const ContextImage::SeenCell& before, const Cell& now,
                                    std::uint8_t tick) {
  if (!now.known()) return {.height_mm = 0, .probability = 0, .tick = tick, .updates = 0};
  const int updates = before.probability == 0 ? 1 : std::min(before.updates + 1, 255);
  return {now.height_mm, now.probability, tick, static_cast<std::uint8_t>(updates)};
}

}  // namespace cairn
