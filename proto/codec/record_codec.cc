#include "proto/codec/record_codec.h"

#include <algorithm>
#include <string>
#include <type_traits>

#include "proto/codec/bytes.h"
#include "proto/codec/fields.h"

namespace cairn::proto {
namespace {

// ---- What each record is made of, in the order of its bytes. ----------------------------------

template <class Io>
void coordinate(Io& io, const char* name, typename Io::template Ref<std::int32_t> value) {
  io.template number<std::int32_t>(name, value, -kMaxCoordinateMm, kMaxCoordinateMm);
}

template <class Io>
void compact_coordinate(Io& io, const char* name, typename Io::template Ref<std::int32_t> value) {
  io.template compact<std::int32_t>(name, value, -kMaxCoordinateMm, kMaxCoordinateMm);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<SubmapPose> r) {
  coordinate(io, "x", r.x_mm);
  coordinate(io, "y", r.y_mm);
  coordinate(io, "z", r.z_mm);
  io.template number<std::int32_t>("yaw", r.yaw_1e4rad, -kMaxYaw1e4rad, kMaxYaw1e4rad);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<TileKey> r) {
  io.number("level", r.level);
  io.template number<std::int32_t>("tx", r.tx, -kMaxTileCoordinate, kMaxTileCoordinate);
  io.template number<std::int32_t>("ty", r.ty, -kMaxTileCoordinate, kMaxTileCoordinate);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<BlockKey> r) {
  io.one_of("layer", r.layer, EvidenceLayer::surface, EvidenceLayer::seen_through);
  fields(io, r.tile);
  io.template number<std::uint8_t>("block", r.block, 0, kBlocksPerTile - 1);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<Hello> r) {
  io.name("robot", r.robot);
  io.name("site", r.site);
  io.number("boot", r.boot);
  io.template number<std::uint16_t>("cell size", r.cell_size_mm, 10, 2000);
  io.number("clock", r.clock_ms);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<PoseReport> r) {
  // It travels every second: no byte more than it takes.
  io.compact("clock", r.clock_ms);
  compact_coordinate(io, "x", r.T_site_robot.x_mm);
  compact_coordinate(io, "y", r.T_site_robot.y_mm);
  compact_coordinate(io, "z", r.T_site_robot.z_mm);
  io.template compact<std::int32_t>("yaw", r.T_site_robot.yaw_1e4rad, -kMaxYaw1e4rad,
                                    kMaxYaw1e4rad);
  io.compact("roll", r.roll_1e4rad);
  io.compact("pitch", r.pitch_1e4rad);
  io.compact("sigma", r.sigma_mm);
  io.compact("speed", r.speed_mm_s);
  io.one_of("drive state", r.drive, DriveState::idle, DriveState::stopped);
  io.one_of("localization", r.localization, Localization::localized, Localization::lost);
  io.flag("asks", r.asks);
  io.compact("command", r.command);
  io.compact("to go", r.to_go_mm);
  io.compact("backlog", r.backlog_blocks);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<SpoolReport> r) {
  io.flag("failed", r.failed);
  io.number("submaps", r.submaps);
  io.number("bytes", r.bytes);
  io.number("thinned", r.thinned);
  io.number("dropped", r.dropped);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<SubmapId> r) {
  io.number("boot", r.boot);
  io.template number<std::uint32_t>("own sequence", r.sequence, 1, kFirstBorrowedSequence - 1);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<SubmapLink> r) {
  fields(io, r.T_previous_submap);
  io.number("sigma xy", r.sigma_xy_mm);
  io.number("sigma z", r.sigma_z_mm);
  io.number("sigma yaw", r.sigma_yaw_1e4rad);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<SubmapHead> r) {
  io.number("sequence", r.sequence);
  io.template number<std::uint32_t>("version", r.version, 1);
  fields(io, r.T_site_submap);
  io.flag("closed", r.closed);
  io.template number<std::uint32_t>("blocks", r.blocks, 0, kMaxSubmapBlocks);
  io.number("final versions", r.final_versions);
  io.require("final versions", r.closed ? r.final_versions >= r.blocks : r.final_versions == 0);
  io.number("edition", r.edition);
  io.optional("link", r.link, [](Io& each, auto& link) { fields(each, link); });
  io.optional("earlier", r.earlier, [](Io& each, auto& id) { fields(each, id); });
  io.require("sequence", r.earlier.has_value() == (r.sequence >= kFirstBorrowedSequence));
}

template <class Io>
void fields(Io& io, typename Io::template Ref<EvidencePatch> r) {
  io.number("sequence", r.sequence);
  io.number("tick", r.tick);
  io.number("epoch", r.ground.epoch);
  io.number("before", r.ground.before);
  io.bytes("back", r.ground.back, kMaxGroundFrames);
  io.require("back", std::ranges::find(r.ground.back, 0) == r.ground.back.end());
  io.rest("patch", r.bytes, kMaxPatchBytes);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<CommandReport> r) {
  io.template number<std::uint64_t>("command", r.command, 1);
  io.number("revision", r.revision);
  io.one_of("state", r.state, CommandState::accepted, CommandState::blocked);
  io.text("why", r.why);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<Welcome> r) {
  io.template number<std::uint32_t>("session", r.session, 1);
  io.number("boot", r.boot);
  io.number("epoch", r.epoch);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<Reject> r) {
  io.number("boot", r.boot);
  io.one_of("reason", r.reason, RejectReason::robot_id_in_use, RejectReason::bad_name);
  io.text("text", r.text);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<Refusal> r) {
  io.number("sequence", r.sequence);
  fields(io, r.key);
  io.number("held", r.held);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<Command> r) {
  io.template number<std::uint64_t>("id", r.id, 1);
  io.number("revision", r.revision);
  io.one_of("kind", r.kind, CommandKind::go_to, CommandKind::stop);
  io.text("issuer", r.issuer);
  io.number("expires", r.expires_clock_ms);
  io.one_of("on link loss", r.on_link_loss, OnLinkLoss::proceed, OnLinkLoss::retrace);
  io.number("link timeout", r.link_timeout_ms);
  io.number("map version", r.map_version);
  coordinate(io, "goal x", r.goal_x_mm);
  coordinate(io, "goal y", r.goal_y_mm);
  io.optional("goal yaw", r.goal_yaw_1e4rad, [](Io& each, auto& yaw) {
    each.template number<std::int32_t>("goal yaw", yaw, -kMaxYaw1e4rad, kMaxYaw1e4rad);
  });
  io.flag("path cut", r.path_cut);
  io.template number<std::uint16_t>("path bytes", r.path_bytes, 0, kMaxPathBytes);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<PathPart> r) {
  io.template number<std::uint64_t>("command", r.command, 1);
  io.number("revision", r.revision);
  io.template number<std::uint8_t>("part", r.part, 0, kMaxPathParts - 1);
  io.rest("bytes", r.bytes, kPartBytes);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<CorridorRequest> r) {
  io.template number<std::uint64_t>("command", r.command, 1);
  io.number("revision", r.revision);
  coordinate(io, "x", r.x_mm);
  coordinate(io, "y", r.y_mm);
  io.template number<std::uint8_t>("half width", r.half_width, 1, kMaxCorridorHalfWidth);
  io.one_of("wish", r.wish, CorridorWish::corridor, CorridorWish::plan);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<CorridorPart> r) {
  io.template number<std::uint64_t>("command", r.command, 1);
  io.number("revision", r.revision);
  io.number("map version", r.map_version);
  io.number("first", r.first);
  io.template number<std::uint16_t>("count", r.count, 1);
  io.template number<std::uint8_t>("half width", r.half_width, 1, kMaxCorridorHalfWidth);
  io.bytes("spine", r.spine, kMaxSpineBytes);
  io.rest("directions", r.directions, kMaxCorridorBytes);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<MapPatch> r) {
  io.template number<std::uint32_t>("step", r.step, 1);
  io.number("holds", r.holds_sequence);
  io.rest("patch", r.bytes, kMaxPatchBytes);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<GroundLost> r) {
  io.number("epoch", r.epoch);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<SubmapMove> r) {
  io.template number<std::uint32_t>("step", r.step, 1);
  io.template number<std::uint32_t>("sequence", r.sequence, 1);
  fields(io, r.T_site_submap);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<MapCommit> r) {
  io.template number<std::uint32_t>("step", r.step, 1);
  io.number("edition", r.edition);
}

template <class Io>
void fields(Io& io, typename Io::template Ref<MapDigest> r) {
  io.flag("last", r.last);
  io.number("holds", r.holds_sequence);
  io.number("level", r.level);
  constexpr std::int32_t kMost = kMaxTileCoordinate / kRegionTiles;
  io.template number<std::int32_t>("rx", r.rx, -kMost, kMost);
  io.template number<std::int32_t>("ry", r.ry, -kMost, kMost);
  constexpr std::uint8_t kTiles = kRegionTiles * kRegionTiles;
  io.list(
      "tiles", r.tiles, kTiles,
      [](Io& each, auto& tile) {
        each.template number<std::uint8_t>("place", tile.place, 0, kTiles - 1);
        each.number("digest", tile.digest);
      },
      0);
  io.require("places", std::ranges::adjacent_find(r.tiles, std::ranges::greater_equal{},
                                                  &MapDigest::Tile::place) == r.tiles.end());
}

template <class Io>
void fields(Io& io, typename Io::template Ref<Ack> r) {
  io.compact("cumulative", r.cumulative);
  io.compact("bitmap", r.bitmap);
  io.compact("delay", r.delay_ms);
}

template <class Io>
void fields(Io& /*io*/, typename Io::template Ref<Bye> /*r*/) {}

template <class Io>
void fields(Io& /*io*/, typename Io::template Ref<Reset> /*r*/) {}

// ---- Type numbers, names and who may send each. ------------------------------------------------

enum class Sender { robot, server, both };

struct Kind {
  std::uint8_t type;
  Sender sender;
  const char* name;
};

template <class R>
constexpr Kind kind_of() {
  if constexpr (std::is_same_v<R, Hello>) return {1, Sender::robot, "hello"};
  if constexpr (std::is_same_v<R, PoseReport>) return {2, Sender::robot, "pose report"};
  if constexpr (std::is_same_v<R, SubmapHead>) return {3, Sender::robot, "submap head"};
  if constexpr (std::is_same_v<R, EvidencePatch>) return {4, Sender::robot, "evidence patch"};
  if constexpr (std::is_same_v<R, CommandReport>) return {5, Sender::robot, "command report"};
  if constexpr (std::is_same_v<R, Bye>) return {6, Sender::robot, "bye"};
  if constexpr (std::is_same_v<R, SpoolReport>) return {7, Sender::robot, "spool report"};
  if constexpr (std::is_same_v<R, CorridorRequest>) return {16, Sender::robot, "corridor request"};
  if constexpr (std::is_same_v<R, Welcome>) return {17, Sender::server, "welcome"};
  if constexpr (std::is_same_v<R, Reject>) return {18, Sender::server, "reject"};
  if constexpr (std::is_same_v<R, Reset>) return {19, Sender::server, "reset"};
  if constexpr (std::is_same_v<R, Refusal>) return {20, Sender::server, "refusal"};
  if constexpr (std::is_same_v<R, Command>) return {21, Sender::server, "command"};
  if constexpr (std::is_same_v<R, PathPart>) return {22, Sender::server, "path part"};
  if constexpr (std::is_same_v<R, MapPatch>) return {23, Sender::server, "map patch"};
  if constexpr (std::is_same_v<R, SubmapMove>) return {24, Sender::server, "submap move"};
  if constexpr (std::is_same_v<R, MapCommit>) return {25, Sender::server, "map commit"};
  if constexpr (std::is_same_v<R, GroundLost>) return {26, Sender::server, "ground lost"};
  if constexpr (std::is_same_v<R, MapDigest>) return {27, Sender::robot, "map digest"};
  if constexpr (std::is_same_v<R, CorridorPart>) return {31, Sender::server, "corridor part"};
  if constexpr (std::is_same_v<R, Ack>) return {32, Sender::both, "ack"};
}

Error malformed(std::string what) {
  return {ErrorCode::corrupt,
          "malformed frame: " + std::move(what) + "; check that both ends run the same version"};
}

template <class R>
Result<Record> read_as(std::span<const std::uint8_t> body, Direction direction) {
  constexpr Kind kKind = kind_of<R>();
  const Sender sender = direction == Direction::up ? Sender::robot : Sender::server;
  if (kKind.sender != Sender::both && kKind.sender != sender) {
    return malformed(std::string(kKind.name) + " sent in the wrong direction");
  }
  FieldReader io{ByteReader(body)};
  R record;
  fields(io, record);
  if (io.failed()) {
    return malformed(std::string(kKind.name) + ": " + io.broken() + " missing or out of bounds");
  }
  if (io.left() > 0) return malformed(std::string(kKind.name) + " with bytes left over");
  return Record(std::move(record));
}

template <class... Rs>
Result<Record> read_any(std::uint8_t type, std::span<const std::uint8_t> body, Direction direction,
                        std::variant<Rs...>* /*types*/) {
  Result<Record> result = malformed("unknown record type " + std::to_string(type));
  (void)((type == kind_of<Rs>().type && (result = read_as<Rs>(body, direction), true)) || ...);
  return result;
}

}  // namespace

void append_record(std::vector<std::uint8_t>& out, const Record& record) {
  std::visit(
      [&out]<class R>(const R& r) {
        ByteWriter writer(out);
        writer.put(kind_of<R>().type);
        const std::size_t length_at = out.size();
        writer.put(std::uint16_t{0});
        FieldWriter io(writer);
        fields(io, r);
        const std::size_t length = out.size() - length_at - 2;
        out[length_at] = static_cast<std::uint8_t>(length & 0xFFU);
        out[length_at + 1] = static_cast<std::uint8_t>(length >> 8U);
      },
      record);
}

Result<Record> read_record(std::uint8_t type, std::span<const std::uint8_t> body,
                           Direction direction) {
  return read_any(type, body, direction, static_cast<Record*>(nullptr));
}

}  // namespace cairn::proto
