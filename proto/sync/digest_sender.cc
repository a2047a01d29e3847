#include "proto/sync/digest_sender.h"

#include <algorithm>
#include <utility>

namespace cairn::proto {
namespace {

std::int32_t region(std::int32_t t) {
  return (t - ((t % kRegionTiles) + kRegionTiles) % kRegionTiles) / kRegionTiles;
}

}  // namespace

std::uint32_t digest_of(const PackedTile& tile) {
  return tile.known_count() == 0 ? 0 : crc32c(tile.bytes());
}

Region region_of(const TileKey& key) { return {key.level, region(key.tx), region(key.ty)}; }

std::uint8_t place_of(const TileKey& key) {
  const Region of = region_of(key);
  return static_cast<std::uint8_t>((key.ty - of.ry * kRegionTiles) * kRegionTiles + key.tx -
                                   of.rx * kRegionTiles);
}

TileKey tile_of(const MapDigest& digest, const MapDigest::Tile& tile) {
  return {digest.level, digest.rx * kRegionTiles + tile.place % kRegionTiles,
          digest.ry * kRegionTiles + tile.place / kRegionTiles};
}

void DigestSender::tell(std::vector<MapDigest> digests) {
  for (MapDigest& digest : digests) {
    if (items_.size() < kMaxWaiting) items_.push_back({std::move(digest)});
  }
}

int DigestSender::fill(FrameWriter& frame, std::uint32_t number) {
  int added = 0;
  for (Item& item : items_) {
    if (!item.transit.waits()) continue;
    if (!frame.add(item.digest)) break;
    item.transit.sent(number);
    ++added;
  }
  return added;
}

void DigestSender::on_acked(std::uint32_t number) {
  for (Item& item : items_) item.transit.on_acked(number);
  std::erase_if(items_, [](const Item& item) { return item.transit.acknowledged(); });
}

void DigestSender::on_lost(std::uint32_t number) {
  for (Item& item : items_) item.transit.on_lost(number);
}

bool DigestSender::has_news() const {
  return std::ranges::any_of(items_, [](const Item& item) { return item.transit.waits(); });
}

}  // namespace cairn::proto
