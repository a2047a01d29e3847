#include "server/store/row_codec.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "proto/codec/bytes.h"
#include "proto/codec/frame.h"
#include "proto/codec/text.h"
#include "proto/codec/tile_snapshot.h"

namespace cairn::server {
namespace {

using proto::ByteReader;
using proto::ByteWriter;

constexpr int kCoordinateBits = 28;
constexpr std::uint64_t kCoordinateMask = (std::uint64_t{1} << kCoordinateBits) - 1;
constexpr std::int32_t kCoordinateLimit = 1 << (kCoordinateBits - 1);
constexpr std::int32_t kMaxYaw1e4rad = 31416;
constexpr int kMinCellSizeMm = 10;
constexpr int kMaxCellSizeMm = 2000;
constexpr std::size_t kMaskBytes = kBlockCells / 8;

Error refused(const std::string& what) { return {ErrorCode::invalid_argument, what}; }
Error corrupt(const std::string& what) { return {ErrorCode::corrupt, what}; }

std::int32_t coordinate(std::uint64_t bits) {
  const auto low = static_cast<std::int32_t>(bits & kCoordinateMask);
  return low < kCoordinateLimit ? low : low - 2 * kCoordinateLimit;
}

void put_name(ByteWriter& out, std::string_view name) {
  out.put(static_cast<std::uint8_t>(name.size()));
  for (const char c : name) out.put(static_cast<std::uint8_t>(c));
}

std::string get_name(ByteReader& in) {
  const ByteSpan bytes = in.take(in.get<std::uint8_t>());
  return {bytes.begin(), bytes.end()};
}

bool complete(const ByteReader& in) { return !in.failed() && in.left() == 0; }

bool plausible(const SiteInfo& info) {
  return proto::valid_name(info.name) && info.cell_size_mm >= kMinCellSizeMm &&
         info.cell_size_mm <= kMaxCellSizeMm;
}

bool plausible(const SubmapPose& pose) {
  return std::int64_t{std::abs(std::int64_t{pose.yaw_1e4rad})} <= kMaxYaw1e4rad;
}

bool plausible(const SubmapRow& row) {
  return proto::valid_name(row.robot) && row.blocks <= proto::kMaxSubmapBlocks &&
         row.state <= SubmapState::merged && plausible(row.T_site_submap) &&
         (!row.link || plausible(row.link->T_previous_submap));
}

bool plausible(const LoopRow& row) {
  const auto finite = [](double value) { return std::isfinite(value); };
  return row.status <= 2 && std::ranges::all_of(row.T_from_to, finite) &&
         std::ranges::all_of(row.information, finite);
}

void put_pose(ByteWriter& out, const SubmapPose& pose) {
  out.put(pose.x_mm);
  out.put(pose.y_mm);
  out.put(pose.z_mm);
  out.put(pose.yaw_1e4rad);
}

SubmapPose get_pose(ByteReader& in) {
  SubmapPose pose;
  pose.x_mm = in.get<std::int32_t>();
  pose.y_mm = in.get<std::int32_t>();
  pose.z_mm = in.get<std::int32_t>();
  pose.yaw_1e4rad = in.get<std::int32_t>();
  return pose;
}

void put_link(ByteWriter& out, const std::optional<SubmapLink>& link) {
  out.put(std::uint8_t{link.has_value()});
  if (!link) return;
  put_pose(out, link->T_previous_submap);
  out.put(link->sigma_xy_mm);
  out.put(link->sigma_z_mm);
  out.put(link->sigma_yaw_1e4rad);
}

std::optional<SubmapLink> get_link(ByteReader& in) {
  const auto linked = in.get<std::uint8_t>();
  if (linked > 1) in.fail();
  if (linked != 1) return std::nullopt;
  SubmapLink link;
  link.T_previous_submap = get_pose(in);
  link.sigma_xy_mm = in.get<std::uint16_t>();
  link.sigma_z_mm = in.get<std::uint16_t>();
  link.sigma_yaw_1e4rad = in.get<std::uint16_t>();
  return link;
}

bool in_range(std::int64_t offset_mm) {
  return offset_mm >= -Tile::kHeightLimitMm && offset_mm <= Tile::kHeightLimitMm;
}

bool held(const BlockDelta& state, std::size_t cell) {
  return state.changed[cell] && state.cells[cell].known();
}

void put_mask(ByteWriter& out, const BlockDelta& state) {
  for (std::size_t byte = 0; byte < kMaskBytes; ++byte) {
    unsigned bits = 0;
    for (std::size_t bit = 0; bit < 8; ++bit) bits |= held(state, byte * 8 + bit) ? 1U << bit : 0U;
    out.put(static_cast<std::uint8_t>(bits));
  }
}

void get_mask(ByteReader& in, BlockDelta& state) {
  for (std::size_t byte = 0; byte < kMaskBytes; ++byte) {
    const unsigned bits = in.get<std::uint8_t>();
    for (std::size_t bit = 0; bit < 8; ++bit) state.changed[byte * 8 + bit] = (bits >> bit) & 1U;
  }
}

}  // namespace

bool storable(const TileKey& key) {
  const auto fits = [](std::int32_t c) { return c >= -kCoordinateLimit && c < kCoordinateLimit; };
  return fits(key.tx) && fits(key.ty);
}

std::int64_t pack(const TileKey& key) {
  assert(storable(key));
  const std::uint64_t level = static_cast<std::uint8_t>(key.level);
  const auto bits = [](std::int32_t c) { return static_cast<std::uint32_t>(c) & kCoordinateMask; };
  return static_cast<std::int64_t>(level << (2 * kCoordinateBits) |
                                   bits(key.tx) << kCoordinateBits | bits(key.ty));
}

TileKey unpack_tile(std::int64_t packed) {
  const auto bits = static_cast<std::uint64_t>(packed);
  return {.level = static_cast<std::int8_t>(bits >> (2 * kCoordinateBits)),
          .tx = coordinate(bits >> kCoordinateBits),
          .ty = coordinate(bits)};
}

std::int64_t pack_part(const BlockKey& key) {
  assert(key.block < kBlocksPerTile);
  return static_cast<std::int64_t>(key.layer) * kBlocksPerTile + key.block;
}

Result<BlockKey> unpack_block(std::int64_t tile, std::int64_t part) {
  if (part < 0 || part >= std::int64_t{2} * kBlocksPerTile)
    return corrupt("a block has an unknown layer");
  return BlockKey{.layer = static_cast<EvidenceLayer>(part / kBlocksPerTile),
                  .tile = unpack_tile(tile),
                  .block = static_cast<std::uint8_t>(part % kBlocksPerTile)};
}

Bytes site_key() { return {'I'}; }

Bytes key_of(const SubmapId& id) {
  Bytes key{'S'};
  ByteWriter out(key);
  out.put(id.boot);
  out.put(id.sequence);
  return key;
}

Bytes key_of(const SubmapId& id, const BlockKey& block) {
  Bytes key = key_of(id);
  key[0] = 'B';
  ByteWriter out(key);
  out.put(pack(block.tile));
  out.put(static_cast<std::uint8_t>(pack_part(block)));
  return key;
}

Bytes key_of(const TileKey& tile) {
  Bytes key{'T'};
  ByteWriter(key).put(pack(tile));
  return key;
}

Bytes key_of(char kind, const SubmapId& from, const SubmapId& to) {
  Bytes key = key_of(from);
  key[0] = static_cast<std::uint8_t>(kind);
  ByteWriter out(key);
  out.put(to.boot);
  out.put(to.sequence);
  return key;
}

Bytes key_of_note(std::string_view name) {
  Bytes key{'N'};
  ByteWriter out(key);
  put_name(out, name);
  return key;
}

std::uint32_t row_crc(ByteSpan key, ByteSpan body) {
  Bytes content(key.begin(), key.end());
  content.insert(content.end(), body.begin(), body.end());
  return proto::crc32c(content);
}

Result<Bytes> encode(const SiteInfo& info) {
  if (!plausible(info)) {
    return refused(
        "a site needs a name of 1 to 32 of a-z, 0-9, _ and -, and cells of 10 to 2000 mm");
  }
  Bytes body;
  ByteWriter out(body);
  put_name(out, info.name);
  out.put(info.epoch);
  out.put(static_cast<std::int32_t>(info.cell_size_mm));
  out.put(info.founded_unix_s);
  return body;
}

Result<SiteInfo> decode_site(ByteSpan body) {
  ByteReader in(body);
  SiteInfo info;
  info.name = get_name(in);
  info.epoch = in.get<std::uint64_t>();
  info.cell_size_mm = in.get<std::int32_t>();
  info.founded_unix_s = in.get<std::int64_t>();
  if (!complete(in) || !plausible(info)) return corrupt("its site row breaks the format");
  return info;
}

Result<Bytes> encode(const SubmapRow& row) {
  if (!plausible(row)) return refused(submap_name(row.id) + " breaks a bound and was not stored");
  Bytes body;
  ByteWriter out(body);
  put_name(out, row.robot);
  out.put(row.head_version);
  put_pose(out, row.T_site_submap);
  out.put(static_cast<std::uint8_t>(row.state));
  out.put(row.blocks);
  out.put(row.final_versions);
  out.put(row.merge_order);
  out.put(row.edition);
  put_link(out, row.link);
  return body;
}

Result<SubmapRow> decode_submap(const SubmapId& id, ByteSpan body) {
  ByteReader in(body);
  SubmapRow row;
  row.id = id;
  row.robot = get_name(in);
  row.head_version = in.get<std::uint32_t>();
  row.T_site_submap = get_pose(in);
  row.state = static_cast<SubmapState>(in.get<std::uint8_t>());
  row.blocks = in.get<std::uint32_t>();
  row.final_versions = in.get<std::uint64_t>();
  row.merge_order = in.get<std::uint64_t>();
  row.edition = in.get<std::uint32_t>();
  row.link = get_link(in);
  if (!complete(in) || !plausible(row)) return corrupt(submap_name(id) + " breaks the format");
  return row;
}

Result<Bytes> encode(const BlockRow& row) {
  if (!storable(row.key.tile) || row.key.block >= kBlocksPerTile) {
    return refused("a block of " + submap_name(row.id) + " lies outside of any map");
  }
  Bytes body;
  ByteWriter out(body);
  out.put(row.version);
  out.put(row.state.datum_mm);
  put_mask(out, row.state);
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    if (!held(row.state, i)) continue;
    const Cell& cell = row.state.cells[i];
    const std::int64_t offset_mm = std::int64_t{cell.height_mm} - row.state.datum_mm;
    if (!in_range(offset_mm)) {
      return refused("a height in a block of " + submap_name(row.id) +
                     " is too far from its datum");
    }
    out.put(cell.probability);
    out.put(static_cast<std::int16_t>(offset_mm));
  }
  return body;
}

Result<BlockRow> decode_block(const SubmapId& id, const BlockKey& key, ByteSpan body) {
  ByteReader in(body);
  BlockRow row{.id = id, .key = key, .version = in.get<std::uint32_t>(), .state = {}};
  row.state.datum_mm = in.get<std::int32_t>();
  get_mask(in, row.state);
  bool sound = true;
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    if (!row.state.changed[i]) continue;
    const auto probability = in.get<std::uint8_t>();
    const std::int64_t offset_mm = in.get<std::int16_t>();
    const std::int64_t height_mm = row.state.datum_mm + offset_mm;
    sound = sound && probability != 0 && in_range(offset_mm) &&
            height_mm == static_cast<std::int32_t>(height_mm);
    row.state.cells[i] = {static_cast<std::int32_t>(height_mm), probability};
  }
  if (!complete(in) || !sound)
    return corrupt("a block of " + submap_name(id) + " breaks the format");
  return row;
}

Result<Bytes> encode(const TileRow& row) {
  if (!storable(row.key)) return refused("a tile lies outside of any map");
  Bytes body;
  ByteWriter(body).put(row.version);
  const Bytes tile = proto::write_tile_snapshot(row.tile);
  body.insert(body.end(), tile.begin(), tile.end());
  return body;
}

Result<TileRow> decode_tile(const TileKey& key, ByteSpan body) {
  ByteReader in(body);
  const auto version = in.get<std::uint64_t>();
  auto tile = proto::read_tile_snapshot(in.take(in.left()));
  if (!tile) return tile.error();
  return TileRow{.key = key, .version = version, .tile = std::move(tile).value()};
}

Result<Bytes> encode(const LoopRow& row) {
  if (!plausible(row)) {
    return refused("the loop from " + submap_name(row.from) + " breaks a bound and was not stored");
  }
  Bytes body;
  ByteWriter out(body);
  out.put(row.status);
  for (const double value : row.T_from_to) out.put(std::bit_cast<std::uint64_t>(value));
  for (const double value : row.information) out.put(std::bit_cast<std::uint64_t>(value));
  return body;
}

Result<LoopRow> decode_loop(const SubmapId& from, const SubmapId& to, ByteSpan body) {
  ByteReader in(body);
  LoopRow row{.from = from, .to = to};
  row.status = in.get<std::uint8_t>();
  for (double& value : row.T_from_to) value = std::bit_cast<double>(in.get<std::uint64_t>());
  for (double& value : row.information) value = std::bit_cast<double>(in.get<std::uint64_t>());
  if (!complete(in) || !plausible(row)) {
    return corrupt("the loop from " + submap_name(from) + " breaks the format");
  }
  return row;
}

Result<Bytes> encode(const TriedRow& row) {
  if (!std::isfinite(row.sigma_m)) return refused("how well a pair was known is no number");
  Bytes body;
  ByteWriter out(body);
  out.put(row.tries);
  out.put(std::bit_cast<std::uint64_t>(row.sigma_m));
  return body;
}

Result<TriedRow> decode_tried(const SubmapId& a, const SubmapId& b, ByteSpan body) {
  ByteReader in(body);
  TriedRow row{.a = a, .b = b, .tries = in.get<std::uint32_t>()};
  row.sigma_m = std::bit_cast<double>(in.get<std::uint64_t>());
  if (!complete(in) || !std::isfinite(row.sigma_m)) {
    return corrupt("the comparison of " + submap_name(a) + " breaks the format");
  }
  return row;
}

Status check_note(std::string_view name, std::string_view value) {
  if (!name.empty() && name.size() <= kMaxNoteNameBytes && value.size() <= kMaxNoteBytes) return {};
  return refused("a note has a name of 1 to 64 bytes and a value of at most 64 KiB");
}

std::string submap_name(const SubmapId& id) {
  char text[64];
  std::snprintf(text, sizeof text, "submap %016llx/%u", static_cast<unsigned long long>(id.boot),
                id.sequence);
  return text;
}

}  // namespace cairn::server
