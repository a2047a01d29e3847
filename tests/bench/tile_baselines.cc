#include "tests/bench/tile_baselines.h"

#include <cstdint>

#include "core/map/packed_tile.h"

#ifdef CAIRN_HAS_ZSTD
#include <zstd.h>
#endif

namespace cairn::bench {
namespace {

using Bytes [[maybe_unused]] = std::vector<std::uint8_t>;

#ifdef CAIRN_HAS_ZSTD
std::size_t zstd(const Bytes& in) {
  Bytes out(ZSTD_compressBound(in.size()));
  return ZSTD_compress(out.data(), out.size(), in.data(), in.size(), 19);
}

void put_number(Bytes& out, unsigned value) {
  for (; value > 127; value >>= 7U) out.push_back(static_cast<std::uint8_t>(value | 128U));
  out.push_back(static_cast<std::uint8_t>(value));
}

unsigned zig_zag(int value) {
  return value < 0 ? 2 * static_cast<unsigned>(-value) - 1 : 2 * static_cast<unsigned>(value);
}

/// Masks, heights, probabilities, each as it is.
Bytes at_rest(const Tile& tile) {
  const PackedTile packed = PackedTile::pack(tile);
  return {packed.bytes().begin(), packed.bytes().end()};
}

/// Gaps between known cells, height differences from cell to cell, probabilities.
Bytes differences(const Tile& tile) {
  Bytes out;
  Bytes heights;
  Bytes probabilities;
  int last_at = -1;
  int last_mm = tile.datum_mm();
  for (int i = 0; i < Tile::kCells; ++i) {
    if (!tile.known(i)) continue;
    put_number(out, static_cast<unsigned>(i - last_at - 1));
    put_number(heights, zig_zag(tile.height_mm(i) - last_mm));
    probabilities.push_back(tile.probability(i));
    last_at = i;
    last_mm = tile.height_mm(i);
  }
  out.insert(out.end(), heights.begin(), heights.end());
  out.insert(out.end(), probabilities.begin(), probabilities.end());
  return out;
}

/// A mask, the high bytes of the height differences, the low ones, probabilities.
Bytes split_differences(const Tile& tile) {
  Bytes out(Tile::kCells / 8);
  Bytes high;
  Bytes low;
  Bytes probabilities;
  int last_mm = tile.datum_mm();
  for (int i = 0; i < Tile::kCells; ++i) {
    if (!tile.known(i)) continue;
    out[static_cast<std::size_t>(i) / 8] |= static_cast<std::uint8_t>(1U << (i % 8));
    const unsigned by = zig_zag(tile.height_mm(i) - last_mm);
    high.push_back(static_cast<std::uint8_t>(by >> 8U));
    low.push_back(static_cast<std::uint8_t>(by));
    probabilities.push_back(tile.probability(i));
    last_mm = tile.height_mm(i);
  }
  for (const Bytes* plane : {&high, &low, &probabilities}) {
    out.insert(out.end(), plane->begin(), plane->end());
  }
  return out;
}
#endif

}  // namespace

std::vector<TileBaseline> tile_baselines() {
  std::vector<TileBaseline> all;
#ifdef CAIRN_HAS_ZSTD
  const auto add = [&](const std::string& name, Bytes (*layout)(const Tile&)) {
    all.push_back({name, [layout](const Tile& tile) { return zstd(layout(tile)); }});
  };
  add("planes as at rest + zstd -19", at_rest);
  add("planes of differences + zstd -19", differences);
  add("planes of split differences + zstd -19", split_differences);
#endif
  return all;
}

}  // namespace cairn::bench
