#include "server/store/row_reader.h"

#include "server/store/row_codec.h"

namespace cairn::server {
namespace {

std::string tile_name(const TileKey& key) {
  return "tile (" + std::to_string(key.tx) + ", " + std::to_string(key.ty) + ") of level " +
         std::to_string(key.level);
}

std::string block_name(const SubmapId& id, const BlockKey& key) {
  return "block " + std::to_string(pack_part(key)) + " in " + tile_name(key.tile) + " of " +
         submap_name(id);
}

Status check_crc(ByteSpan key, ByteSpan body, std::int64_t crc, const std::string& name) {
  if (crc == std::int64_t{row_crc(key, body)}) return {};
  return Error{ErrorCode::corrupt, name + " fails its checksum: restore the site from a backup"};
}

std::pair<SubmapId, SubmapId> pair_of(const sqlite::Statement& row) {
  const auto id = [&row](int column) {
    return SubmapId{static_cast<std::uint64_t>(row.integer(column)),
                    static_cast<std::uint32_t>(row.integer(column + 1))};
  };
  return {id(0), id(2)};
}

Status check_pair(char kind, const sqlite::Statement& row) {
  const auto [from, to] = pair_of(row);
  return check_crc(key_of(kind, from, to), row.bytes(4), row.integer(5),
                   "what is known of " + submap_name(from) + " and " + submap_name(to));
}

}  // namespace

Result<SiteInfo> read_site(const sqlite::Statement& row) {
  if (auto sound = check_crc(site_key(), row.bytes(0), row.integer(1), "the site row"); !sound) {
    return sound.error();
  }
  return decode_site(row.bytes(0));
}

Result<SubmapRow> read_submap(const sqlite::Statement& row) {
  const SubmapId id{static_cast<std::uint64_t>(row.integer(0)),
                    static_cast<std::uint32_t>(row.integer(1))};
  if (auto sound = check_crc(key_of(id), row.bytes(2), row.integer(3), submap_name(id)); !sound) {
    return sound.error();
  }
  return decode_submap(id, row.bytes(2));
}

Result<BlockRow> read_block(const sqlite::Statement& row, const SubmapId& id) {
  const auto key = unpack_block(row.integer(0), row.integer(1));
  if (!key) return key.error();
  const auto sound =
      check_crc(key_of(id, *key), row.bytes(2), row.integer(3), block_name(id, *key));
  if (!sound) return sound.error();
  return decode_block(id, *key, row.bytes(2));
}

Result<TileRow> read_tile(const sqlite::Statement& row) {
  const TileKey key = unpack_tile(row.integer(0));
  if (auto sound = check_crc(key_of(key), row.bytes(1), row.integer(2), tile_name(key)); !sound) {
    return sound.error();
  }
  return decode_tile(key, row.bytes(1));
}

Result<LoopRow> read_loop(const sqlite::Statement& row) {
  const auto [from, to] = pair_of(row);
  if (auto sound = check_pair('L', row); !sound) return sound.error();
  return decode_loop(from, to, row.bytes(4));
}

Result<TriedRow> read_tried(const sqlite::Statement& row) {
  const auto [a, b] = pair_of(row);
  if (auto sound = check_pair('C', row); !sound) return sound.error();
  return decode_tried(a, b, row.bytes(4));
}

Result<std::pair<std::string, std::string>> read_note(const sqlite::Statement& row) {
  std::string name(row.text(0));
  std::string value(row.text(1));
  if (auto bounded = check_note(name, value); !bounded) {
    return Error{ErrorCode::corrupt, "a note breaks the format"};
  }
  const auto sound =
      check_crc(key_of_note(name), row.bytes(1), row.integer(2), "note '" + name + "'");
  if (!sound) return sound.error();
  return std::pair(std::move(name), std::move(value));
}

}  // namespace cairn::server
