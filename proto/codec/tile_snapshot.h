#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/common/result.h"
#include "core/map/packed_tile.h"

/// A whole tile for disks and clients: a packed tile's content in planes that compress well,
/// compressed by zstd. (Links carry tiles as patches, which are smaller and slower.)
///
/// Bytes: version u8 = 2 | one zstd frame (RFC 8878) of: datum, presence and masks as in a
/// PackedTile | for each known cell, in its order, the low byte of its height's miss | the high
/// bytes | the probabilities. A miss is the height less the one expected, both from the datum,
/// modulo 2^16, zig-zagged (0, -1, 1, -2 … as 0, 1, 2, 3 …). Of the cells W, N (y - 1) and NW, as
/// far as they lie in the tile, are known and come before: if all three, the height expected is
/// that of W or N which is nearer to NW when NW is not between them, else W + N - NW (Weinberger,
/// Seroussi and Sapiro 2000: LOCO-I); without NW the mean of W and N rounded down; else W or N;
/// else the height of the known cell before (0 at first).
namespace cairn::proto {

[[nodiscard]] std::vector<std::uint8_t> write_tile_snapshot(const PackedTile& tile);

/// Checks every bound; corrupt when one is broken, unsupported_version for other versions.
[[nodiscard]] Result<PackedTile> read_tile_snapshot(std::span<const std::uint8_t> bytes);

/// [bytes] No snapshot is longer: what does not compress grows by little.
inline constexpr std::size_t kMaxTileSnapshotBytes = PackedTile::kMaxBytes + 128;

}  // namespace cairn::proto
