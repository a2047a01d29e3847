#pragma once

#include <random>
#include <string>

#include "proto/codec/records.h"

/// Random records within their bounds, the bounds themselves often among them.
namespace cairn::proto::testing {

class RandomRecords {
 public:
  explicit RandomRecords(std::uint64_t seed) : random_(seed) {}

  Record any() {
    switch (between<int>(0, 20)) {
      case 0:
        return Hello{name(), name(), whole<std::uint64_t>(), between<std::uint16_t>(10, 2000),
                     whole<std::uint64_t>()};
      case 1:
        return pose();
      case 2:
        return head();
      case 3:
        return EvidencePatch{whole<std::uint32_t>(), whole<std::uint8_t>(), ground(),
                             some_bytes(1100)};
      case 4:
        return CommandReport{id(), whole<std::uint32_t>(), pick<CommandState>(1, 7), text()};
      case 5:
        return Bye{};
      case 6:
        return Welcome{between<std::uint32_t>(1, ~0U), id(), id()};
      case 7:
        return Reject{id(), pick<RejectReason>(1, 5), text()};
      case 8:
        return Reset{};
      case 9:
        return Refusal{whole<std::uint32_t>(), key(), whole<std::uint32_t>()};
      case 10:
        return command();
      case 11:
        return part();
      case 12:
        return MapPatch{between<std::uint32_t>(1, ~0U), whole<std::uint32_t>(), some_bytes(1100)};
      case 13:
        return SubmapMove{between<std::uint32_t>(1, ~0U), between<std::uint32_t>(1, ~0U), place()};
      case 14:
        return MapCommit{between<std::uint32_t>(1, ~0U), whole<std::uint32_t>()};
      case 15:
        return GroundLost{whole<std::uint8_t>()};
      case 16:
        return SpoolReport{percent(50), whole<std::uint32_t>(), whole<std::uint64_t>(),
                           whole<std::uint32_t>(), whole<std::uint32_t>()};
      case 17:
        return CorridorRequest{id(),         whole<std::uint32_t>(), coordinate(),
                               coordinate(), half_width(),           pick<CorridorWish>(1, 2)};
      case 18:
        return corridor();
      case 19:
        return digest();
      default:
        return Ack{whole<std::uint32_t>(), whole<std::uint64_t>(), whole<std::uint16_t>()};
    }
  }

  MapDigest digest() {
    constexpr std::int32_t kMost = kMaxTileCoordinate / kRegionTiles;
    MapDigest digest{percent(50),
                     whole<std::uint32_t>(),
                     whole<std::int8_t>(),
                     between<std::int32_t>(-kMost, kMost),
                     between<std::int32_t>(-kMost, kMost),
                     {}};
    for (std::uint8_t place = 0; place < kRegionTiles * kRegionTiles; ++place) {
      if (percent(50)) digest.tiles.push_back({place, whole<std::uint32_t>()});
    }
    return digest;
  }

  BlockUpdate block() {
    const auto base = between<std::uint32_t>(0, ~0U - 1);
    BlockUpdate update{
        whole<std::uint32_t>(), key(), base, between<std::uint32_t>(base + 1, ~0U), {}};
    fill(update.delta);
    return update;
  }

  template <class T>
  T between(T least, T most) {
    if (percent(5)) return percent(50) ? least : most;
    using Wide = std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>;
    return static_cast<T>(std::uniform_int_distribution<Wide>(least, most)(random_));
  }
  bool percent(int p) { return std::uniform_int_distribution<int>(0, 99)(random_) < p; }

 private:
  template <class T>
  T whole() {
    return between(std::numeric_limits<T>::min(), std::numeric_limits<T>::max());
  }
  template <class E>
  E pick(int first, int last) {
    return static_cast<E>(between(first, last));
  }
  std::uint64_t id() { return between<std::uint64_t>(1, ~0ULL); }
  std::int32_t coordinate() { return between(-kMaxCoordinateMm, kMaxCoordinateMm); }
  TileKey tile() {
    const auto coordinate = [this] { return between(-kMaxTileCoordinate, kMaxTileCoordinate); };
    return {whole<std::int8_t>(), coordinate(), coordinate()};
  }
  std::vector<std::uint8_t> some_bytes(std::size_t most) {
    std::vector<std::uint8_t> bytes(between<std::size_t>(1, most));
    for (auto& byte : bytes) byte = whole<std::uint8_t>();
    return bytes;
  }
  CommonGround ground() {
    CommonGround ground{whole<std::uint8_t>(), whole<std::uint8_t>(), {}};
    for (int i = between(0, static_cast<int>(kMaxGroundFrames)); i > 0; --i) {
      ground.back.push_back(between<std::uint8_t>(1, 255));
    }
    return ground;
  }
  std::uint8_t part_of_tile() { return between<std::uint8_t>(0, 15); }
  BlockKey key() { return {pick<EvidenceLayer>(0, 1), tile(), part_of_tile()}; }
  void fill(BlockDelta& delta) {
    delta.datum_mm = coordinate();
    const int density = between(1, 100);
    for (std::size_t i = 0; i < kBlockCells; ++i) delta.changed[i] = percent(density);
    delta.changed.set(between<std::size_t>(0, kBlockCells - 1));
    const int spread = percent(30) ? Tile::kHeightLimitMm : 300;
    for (Cell& cell : delta.cells) {
      const int height = delta.datum_mm + between(-spread, spread);
      if (!percent(10)) cell = {height, between<std::uint8_t>(1, 255)};
    }
  }
  SubmapPose place() {
    return {coordinate(), coordinate(), coordinate(), between(-kMaxYaw1e4rad, kMaxYaw1e4rad)};
  }
  std::string name() {
    static constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyz0123456789_-";
    std::string out;
    const auto length = between<std::size_t>(1, kMaxNameBytes);
    while (out.size() < length) out += kAllowed[between<std::size_t>(0, kAllowed.size() - 1)];
    return out;
  }
  std::string text() {
    std::string out;
    const auto length = between<std::size_t>(0, kMaxTextBytes);
    while (out.size() + 4 <= length) out += percent(20) ? "°" : percent(10) ? "🪨" : "a";
    return out;
  }
  PoseReport pose() {
    return {whole<std::uint64_t>(), place(),
            whole<std::int16_t>(),  whole<std::int16_t>(),
            whole<std::uint16_t>(), whole<std::int16_t>(),
            pick<DriveState>(0, 3), pick<Localization>(0, 2),
            whole<std::uint64_t>(), whole<std::uint32_t>(),
            whole<std::uint32_t>(), percent(50)};
  }
  SubmapHead head() {
    SubmapHead head{between<std::uint32_t>(0, kFirstBorrowedSequence - 1),
                    between<std::uint32_t>(1, ~0U),
                    place(),
                    percent(50),
                    between<std::uint32_t>(0, kMaxSubmapBlocks),
                    0,
                    whole<std::uint32_t>()};
    if (percent(70)) {
      head.link = SubmapLink{place(), whole<std::uint16_t>(), whole<std::uint16_t>(),
                             whole<std::uint16_t>()};
    }
    if (head.closed) head.final_versions = between<std::uint64_t>(head.blocks, ~0ULL);
    if (percent(30)) {
      head.earlier = SubmapId{id(), between<std::uint32_t>(1, kFirstBorrowedSequence - 1)};
      head.sequence += kFirstBorrowedSequence;
    }
    return head;
  }
  Command command() {
    return {id(),
            whole<std::uint32_t>(),
            pick<CommandKind>(1, 2),
            text(),
            whole<std::uint64_t>(),
            pick<OnLinkLoss>(0, 2),
            whole<std::uint32_t>(),
            whole<std::uint64_t>(),
            coordinate(),
            coordinate(),
            percent(50) ? std::optional(place().yaw_1e4rad) : std::nullopt,
            percent(20),
            between<std::uint16_t>(0, kMaxPathBytes)};
  }
  PathPart part() {
    return {id(), whole<std::uint32_t>(), between<std::uint8_t>(0, kMaxPathParts - 1),
            some_bytes(kPartBytes)};
  }
  std::uint8_t half_width() { return between<std::uint8_t>(1, kMaxCorridorHalfWidth); }
  CorridorPart corridor() {
    CorridorPart part{id(),
                      whole<std::uint32_t>(),
                      whole<std::uint64_t>(),
                      whole<std::uint16_t>(),
                      between<std::uint16_t>(1, 0xFFFF),
                      half_width(),
                      {},
                      some_bytes(kMaxCorridorBytes)};
    if (percent(50)) part.spine = some_bytes(kMaxSpineBytes);
    return part;
  }

  std::mt19937_64 random_;
};

}  // namespace cairn::proto::testing
