#include "proto/sync/map_sender.h"

#include <algorithm>
#include <cassert>

namespace cairn::proto {
namespace {

MapBlock block_of(std::uint32_t step, const MapOffer::Part& part, const Tile& tile,
                  std::uint8_t block) {
  return {step, part.key, block, part.holds_sequence, diff(nullptr, &tile, block)};
}

/// Says that a tile holds nothing any more.
MapBlock empty_block(std::uint32_t step, const MapOffer::Part& part, const Tile& tile) {
  MapBlock block{step, part.key, 0, part.holds_sequence, {}};
  block.content.datum_mm = tile.datum_mm();
  block.content.changed.set(0);
  return block;
}

}  // namespace

void MapSender::offer(const MapOffer& offer) {
  assert(idle());
  assert(offer.tiles.size() <= kMaxTiles && offer.moves.size() <= kMaxMoves);
  for (const SubmapPlace& place : offer.moves) {
    items_.push_back({SubmapMove{step(), place.sequence, place.T_site_submap}});
  }
  for (const MapOffer::Part& part : offer.tiles) add_tile(part);
  edition_ = offer.edition;
  committing_ = false;
  commit_if_all_acknowledged();
}

void MapSender::add_tile(const MapOffer::Part& part) {
  const Tile tile = part.tile.unpack();
  bool anything = false;
  for (std::uint8_t block = 0; block < kBlocksPerTile; ++block) {
    const MapBlock record = block_of(step(), part, tile, block);
    if (record.content.changed.none()) continue;
    anything = true;
    items_.push_back({record});
  }
  if (!anything) items_.push_back({empty_block(step(), part, tile)});
}

int MapSender::fill(FrameWriter& frame, std::uint32_t number) {
  int added = 0;
  for (Item& item : items_) {
    if (item.where != Where::waiting) continue;
    if (!frame.add(item.record)) break;
    item.where = Where::under_way;
    item.carrier = number;
    ++added;
  }
  return added;
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
  if (!all) return;
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
  return std::ranges::any_of(items_, [](const Item& item) { return item.where == Where::waiting; });
}

}  // namespace cairn::proto
