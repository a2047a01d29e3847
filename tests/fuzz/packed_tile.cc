// Tiles at rest: what is taken for one is one, to the byte.

#include "core/map/packed_tile.h"

#include <algorithm>

#include "proto/codec/tile_snapshot.h"
#include "tests/fuzz/input.h"

using namespace cairn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  if (const auto snapshot = proto::read_tile_snapshot(bytes)) {
    const auto again = proto::read_tile_snapshot(proto::write_tile_snapshot(*snapshot));
    fuzz::require(again && *again == *snapshot);
  }
  const auto packed = PackedTile::from_bytes(bytes);
  if (!packed) return 0;
  const PackedTile again = PackedTile::pack(packed->unpack());
  fuzz::require(again.known_count() == packed->known_count() && again.unpack() == packed->unpack());
  return 0;
}
