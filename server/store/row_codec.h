#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/common/result.h"
#include "server/store/store.h"

/// How rows are bytes (FORMAT.md): a key, which SQLite also orders by, a body, and a checksum over
/// both.
namespace cairn::server {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

inline constexpr std::size_t kMaxNoteNameBytes = 64;
inline constexpr std::size_t kMaxNoteBytes = 65536;

/// Level, tx and ty in one integer. Requires: storable(key).
[[nodiscard]] std::int64_t pack(const TileKey& key);
[[nodiscard]] TileKey unpack_tile(std::int64_t packed);
/// Whether its coordinates fit the packed key: all that a cell's int32 index can address do.
[[nodiscard]] bool storable(const TileKey& key);

/// Layer and block within the tile. Requires: block < 16.
[[nodiscard]] std::int64_t pack_part(const BlockKey& key);
/// corrupt when it is no packed part.
[[nodiscard]] Result<BlockKey> unpack_block(std::int64_t tile, std::int64_t part);

/// The keys as the checksum sees them.
[[nodiscard]] Bytes site_key();
[[nodiscard]] Bytes key_of(const SubmapId& id);
[[nodiscard]] Bytes key_of(const SubmapId& id, const BlockKey& key);
[[nodiscard]] Bytes key_of(const TileKey& key);
/// Of a loop ('L') or of a pair that was tried ('C').
[[nodiscard]] Bytes key_of(char kind, const SubmapId& from, const SubmapId& to);
[[nodiscard]] Bytes key_of_note(std::string_view name);

/// CRC-32C over key, then body.
[[nodiscard]] std::uint32_t row_crc(ByteSpan key, ByteSpan body);

/// Bodies. invalid_argument when a value breaks a bound of the format.
[[nodiscard]] Result<Bytes> encode(const SiteInfo& info);
[[nodiscard]] Result<Bytes> encode(const SubmapRow& row);
[[nodiscard]] Result<Bytes> encode(const BlockRow& row);
[[nodiscard]] Result<Bytes> encode(const TileRow& row);
[[nodiscard]] Result<Bytes> encode(const LoopRow& row);
[[nodiscard]] Result<Bytes> encode(const TriedRow& row);
[[nodiscard]] Status check_note(std::string_view name, std::string_view value);

/// corrupt when a bound is broken or bytes are missing or left over.
[[nodiscard]] Result<SiteInfo> decode_site(ByteSpan body);
[[nodiscard]] Result<SubmapRow> decode_submap(const SubmapId& id, ByteSpan body);
[[nodiscard]] Result<BlockRow> decode_block(const SubmapId& id, const BlockKey& key, ByteSpan body);
[[nodiscard]] Result<TileRow> decode_tile(const TileKey& key, ByteSpan body);
[[nodiscard]] Result<LoopRow> decode_loop(const SubmapId& from, const SubmapId& to, ByteSpan body);
[[nodiscard]] Result<TriedRow> decode_tried(const SubmapId& a, const SubmapId& b, ByteSpan body);

/// For messages: "submap 00000000000000ab/7".
[[nodiscard]] std::string submap_name(const SubmapId& id);

}  // namespace cairn::server
