#pragma once

#include "core/delta/block.h"
#include "proto/codec/bytes.h"

namespace cairn::proto {

/// [bytes] The longest block payload: count, mask, 256 × (probability, height of three bytes).
inline constexpr std::size_t kMaxBlockPayloadBytes = 1 + 32 + 256 * (1 + 3);

/// Writes the changed cells of a block. Its datum is not part of the payload.
/// Requires: at least one changed cell; every known height within Tile::kHeightLimitMm of the
/// datum.
void write_block(ByteWriter& out, const BlockDelta& delta);

/// Reads the changed cells of a block whose datum is already in `delta`. Fails the reader when a
/// rule of the payload (PROTOCOL.md) is broken.
void read_block(ByteReader& in, BlockDelta& delta);

}  // namespace cairn::proto
