#include "proto/codec/block_codec.h"

#include <cassert>
#include <cstdlib>

namespace cairn::proto {
namespace {

// Below this many cells a list of their places is shorter than the mask of 32 bytes.
constexpr std::size_t kMaskFrom = 32;
constexpr std::uint8_t kMaskFollows = 0;

void write_places(ByteWriter& out, const std::bitset<kBlockCells>& changed) {
  if (changed.count() < kMaskFrom) {
    out.put(static_cast<std::uint8_t>(changed.count()));
    for (std::size_t i = 0; i < kBlockCells; ++i) {
      if (changed[i]) out.put(static_cast<std::uint8_t>(i));
    }
    return;
  }
  out.put(kMaskFollows);
  for (std::size_t byte = 0; byte < kBlockCells / 8; ++byte) {
    unsigned bits = 0;
    for (std::size_t i = 0; i < 8; ++i) bits |= (changed[8 * byte + i] ? 1U : 0U) << i;
    out.put(static_cast<std::uint8_t>(bits));
  }
}

void read_mask(ByteReader& in, std::bitset<kBlockCells>& changed) {
  for (std::size_t byte = 0; byte < kBlockCells / 8; ++byte) {
    const unsigned bits = in.get<std::uint8_t>();
    for (std::size_t i = 0; i < 8; ++i) changed[8 * byte + i] = ((bits >> i) & 1U) != 0;
  }
  if (changed.count() < kMaskFrom) in.fail();
}

void read_list(ByteReader& in, std::size_t count, std::bitset<kBlockCells>& changed) {
  int last = -1;
  for (std::size_t i = 0; i < count; ++i) {
    const int place = in.get<std::uint8_t>();
    if (place <= last) return in.fail();
    changed.set(static_cast<std::size_t>(place));
    last = place;
  }
}

void read_places(ByteReader& in, std::bitset<kBlockCells>& changed) {
  const std::size_t count = in.get<std::uint8_t>();
  if (count == kMaskFollows) return read_mask(in, changed);
  if (count >= kMaskFrom) return in.fail();
  read_list(in, count, changed);
}

}  // namespace

void write_block(ByteWriter& out, const BlockDelta& delta) {
  assert(delta.changed.any());
  write_places(out, delta.changed);
  std::int32_t last_mm = delta.datum_mm;
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    if (!delta.changed[i]) continue;
    const Cell& cell = delta.cells.at(i);
    out.put(cell.probability);
    if (!cell.known()) continue;
    assert(std::abs(std::int64_t{cell.height_mm} - delta.datum_mm) <= Tile::kHeightLimitMm);
    out.put_varint(cell.height_mm - last_mm);
    last_mm = cell.height_mm;
  }
}

void read_block(ByteReader& in, BlockDelta& delta) {
  read_places(in, delta.changed);
  std::int64_t offset_mm = 0;  // Of the last known cell from the datum.
  for (std::size_t i = 0; i < kBlockCells && !in.failed(); ++i) {
    if (!delta.changed[i]) continue;
    Cell& cell = delta.cells.at(i);
    cell.probability = in.get<std::uint8_t>();
    if (!cell.known()) continue;
    offset_mm += in.get_varint();
    if (std::abs(offset_mm) > Tile::kHeightLimitMm) return in.fail();
    cell.height_mm = static_cast<std::int32_t>(delta.datum_mm + offset_mm);
  }
}

}  // namespace cairn::proto
