#include "proto/sync/map_sender.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "proto/codec/patch.h"

namespace cairn::proto {
namespace {

/// [bytes] Of a MapPatch before its patch.
constexpr std::size_t kMapPatchHeadBytes = 8;
/// A part of a frame smaller than this is left empty: patches far below a frame cost more.
constexpr std::size_t kLeastRoom = kEnoughForABlock;

/// The tile's blocks that hold something; one with one unknown cell when none does.
std::vector<BlockUpdate> blocks_of(const TileKey& key, const Tile& tile) {
  std::vector<BlockUpdate> blocks;
  for (std::uint8_t block = 0; block < kBlocksPerTile; ++block) {
    BlockUpdate update{0, {EvidenceLayer::surface, key, block}, 0, 1, diff(nullptr, &tile, block)};
    if (update.delta.changed.any()) blocks.push_back(update);
  }
  if (!blocks.empty()) return blocks;
  BlockUpdate nothing{0, {EvidenceLayer::surface, key, 0}, 0, 1, {}};
  nothing.delta.datum_mm = tile.datum_mm();
  nothing.delta.changed.set(0);
  return {nothing};
}

}  // namespace

void MapSender::offer(const MapOffer& offer) {
  assert(idle());
  assert(offer.tiles.size() <= kMaxTiles && offer.moves.size() <= kMaxMoves);
  for (const SubmapPlace& place : offer.moves) {
    items_.push_back({SubmapMove{step(), place.sequence, place.T_site_submap}});
  }
  tiles_.assign(offer.tiles.rbegin(), offer.tiles.rend());
  edition_ = offer.edition;
  committing_ = false;
  commit_if_all_acknowledged();
}

int MapSender::fill(FrameWriter& frame, std::uint32_t number) {
  int added = 0;
  for (std::size_t i = 0; i < items_.size() || pack_next(frame); ++i) {
    Item& item = items_[i];
    if (item.where != Where::waiting) continue;
    if (!frame.add(item.record)) break;
    item.where = Where::under_way;
    item.carrier = number;
    ++added;
  }
  return added;
}

/// Makes one more patch, as long as the frame has room for; false when there is nothing to make one
/// of or too little room.
bool MapSender::pack_next(const FrameWriter& frame) {
  if (!unpacked_ && !tiles_.empty()) {
    unpacked_ = {tiles_.back().holds_sequence,
                 blocks_of(tiles_.back().key, tiles_.back().tile.unpack())};
    tiles_.pop_back();
  }
  if (!unpacked_ || frame.room_bytes() < kLeastRoom + kMapPatchHeadBytes) return false;
  const std::size_t room = std::min(frame.room_bytes() - kMapPatchHeadBytes, kMaxPatchBytes);
  PatchBytes patch = write_patch(unpacked_->blocks, {}, kExact, {}, room);
  assert(!patch.taken.empty());
  for (auto taken = patch.taken.rbegin(); taken != patch.taken.rend(); ++taken) {
    unpacked_->blocks.erase(unpacked_->blocks.begin() + static_cast<std::ptrdiff_t>(*taken));
  }
  items_.push_back({MapPatch{step(), unpacked_->holds_sequence, std::move(patch.bytes)}});
  if (unpacked_->blocks.empty()) unpacked_.reset();
  return true;
}

void MapSender::on_acked(std::uint32_t number) {
  for (Item& item : items_) {
    if (item.where != Where::waiting && item.carrier == number) item.where = Where::acknowledged;
  }
  commit_if_all_acknowledged();
}

void MapSender::on_lost(std::uint32_t number) {
  for (Item& item : items_) {
    if (item.where == Where::under_way && item.carrier == number) item.where = Where::waiting;
  }
}

void MapSender::commit_if_all_acknowledged() {
  const bool all = std::ranges::all_of(
      items_, [](const Item& item) { return item.where == Where::acknowledged; });
  if (!all || more_to_pack()) return;
  items_.clear();
  if (committing_) {
    committing_ = false;
    ++steps_done_;
    return;
  }
  committing_ = true;
  items_.push_back({MapCommit{.step = step(), .edition = edition_}});
}

bool MapSender::has_news() const {
  return more_to_pack() ||
         std::ranges::any_of(items_, [](const Item& item) { return item.where == Where::waiting; });
}

}  // namespace cairn::proto
