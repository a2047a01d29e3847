#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/delta/block.h"
#include "core/map/submap.h"

/// The records that frames are made of. PROTOCOL.md says who sends each and when; the bounds here
/// are checked on decoding, and what breaks one is refused.
namespace cairn::proto {

inline constexpr std::size_t kMaxNameBytes = 32;   ///< Robot ids and site names: [a-z0-9_-]+
inline constexpr std::size_t kMaxTextBytes = 160;  ///< Reasons for people, UTF-8.
/// [bytes] Of a path, coded as in core/planner/corridor.h: more than a kilometre of turns.
inline constexpr std::size_t kMaxPathBytes = 4000;
inline constexpr std::size_t kPartBytes = 1000;  ///< Of each part of a path but the last.
/// [bytes] Of a stretch of corridor: its own path, and its directions.
inline constexpr std::size_t kMaxSpineBytes = 200;
inline constexpr std::size_t kMaxCorridorBytes = 900;
inline constexpr std::uint8_t kMaxCorridorHalfWidth = 64;  ///< [cells]
/// [mm] Of every position, goal and tile datum (HeightMap::kMaxExtentM).
inline constexpr std::int32_t kMaxCoordinateMm = 100'000'000;
inline constexpr std::int32_t kMaxYaw1e4rad = 31416;
inline constexpr std::int32_t kMaxTileCoordinate = 1 << 20;  ///< |tx|, |ty|; level: any int8.

// ---- robot → server -------------------------------------------------------------------------

/// Opens a session. `boot` names this run of the agent (and its submaps); `clock_ms` is the robot's
/// monotonic clock.
struct Hello {
  std::string robot;
  std::string site;
  std::uint64_t boot = 0;
  std::uint16_t cell_size_mm = 0;  ///< [Limit: 10 … 2000]
  std::uint64_t clock_ms = 0;
  friend bool operator==(const Hello&, const Hello&) = default;
};

enum class DriveState : std::uint8_t { idle = 0, driving = 1, blocked = 2, stopped = 3 };

/// How sure the robot is of where it is (T4.3.3).
enum class Localization : std::uint8_t {
  localized = 0,
  unsure = 1,  ///< The newest short-term maps did not fit.
  lost = 2,    ///< The pose is a guess; nothing is added to the map.
};

/// Where the robot is and what it does; newest only, never resent.
struct PoseReport {
  std::uint64_t clock_ms = 0;  ///< Robot's monotonic clock when this was true.
  SubmapPose T_site_robot;
  std::int16_t roll_1e4rad = 0;   ///< [1e-4 rad]
  std::int16_t pitch_1e4rad = 0;  ///< [1e-4 rad]
  std::uint16_t sigma_mm = 0;     ///< Standard deviation of the position, saturating.
  std::int16_t speed_mm_s = 0;
  DriveState drive = DriveState::idle;
  Localization localization = Localization::localized;
  std::uint64_t command = 0;         ///< Command being carried out; 0 = none.
  std::uint32_t to_go_mm = 0;        ///< Distance left along the path.
  std::uint32_t backlog_blocks = 0;  ///< Evidence blocks not yet acknowledged.
  bool asks = false;                 ///< For an acknowledgement: is the server still there?
  friend bool operator==(const PoseReport&, const PoseReport&) = default;
};

/// What the robot keeps on its disk of the evidence that the server does not hold; newest only,
/// never resent. A robot that keeps none says nothing.
struct SpoolReport {
  bool failed = false;        ///< The disk takes no more: what is new is in memory only.
  std::uint32_t submaps = 0;  ///< Not held by the server in full, on disk or in memory.
  std::uint64_t bytes = 0;    ///< On disk.
  std::uint32_t thinned = 0;  ///< Submaps of which the layer seen through had to go, in this boot.
  std::uint32_t dropped = 0;  ///< Submaps that had to go whole, in this boot.
  friend bool operator==(const SpoolReport&, const SpoolReport&) = default;
};

/// Sequences from here on name, for the time of a session, submaps of earlier boots.
inline constexpr std::uint32_t kFirstBorrowedSequence = 0x8000'0000;

/// A submap's head. When `closed`, `blocks` tells how many blocks it has in all, so that the server
/// knows when it holds everything. `edition` names the newest MapCommit that the pose accounts for:
/// a server that has moved the robot's submaps since then moves this one, too.
///
/// A robot that took up a submap from its disk does not know what the server holds of it beyond
/// that. It closes it when everything it has was acknowledged, and counts no blocks: then what the
/// server holds is all.
struct SubmapHead {
  std::uint32_t sequence = 0;
  std::uint32_t version = 0;  ///< Counts changes of this head. [Limit: ≥ 1]
  SubmapPose T_site_submap;
  bool closed = false;
  std::uint32_t blocks = 0;          ///< [Limit: ≤ kMaxSubmapBlocks]
  std::uint64_t final_versions = 0;  ///< Sum of all blocks' versions when closed, else 0.
  std::uint32_t edition = 0;
  std::optional<SubmapLink> link{};  ///< None for the boot's first submap.
  /// Whose sequence is borrowed (≥ kFirstBorrowedSequence): the submap's own name. An edition is
  /// counted in that boot.
  std::optional<SubmapId> earlier{};
  friend bool operator==(const SubmapHead&, const SubmapHead&) = default;
};
inline constexpr std::uint32_t kMaxSubmapBlocks = 65536;

/// New values of one block: from any version ≥ `base` to `version`. At least one cell changed.
/// Travels in patches.
struct BlockUpdate {
  std::uint32_t sequence = 0;  ///< Of the submap.
  BlockKey key;
  std::uint32_t base = 0;  ///< [Limit: < version]
  std::uint32_t version = 0;
  BlockDelta delta;
};

/// [bytes] Of a patch: what a frame has room for.
inline constexpr std::size_t kMaxPatchBytes = 1180;
inline constexpr std::size_t kMaxGroundFrames = 32;

/// On what an evidence patch is told: the image made of the patches of certain frames, all
/// acknowledged. Counted are the frames merged into it, in their order.
struct CommonGround {
  std::uint8_t epoch = 0;   ///< Counts how often the robot began with an empty image.
  std::uint8_t before = 0;  ///< Frames merged before those named next, modulo 256.
  /// The frames merged since, named by how many numbers before this frame. [Limit: ≥ 1 each, at
  /// most kMaxGroundFrames]
  std::vector<std::uint8_t> back;
  friend bool operator==(const CommonGround&, const CommonGround&) = default;
};

/// Changed blocks of one submap.
struct EvidencePatch {
  std::uint32_t sequence = 0;  ///< Of the submap.
  std::uint8_t tick = 0;       ///< Counts the rounds in which evidence set out, modulo 256.
  CommonGround ground;
  std::vector<std::uint8_t> bytes;  ///< As in patch.h. [Limit: 1 … kMaxPatchBytes]
  friend bool operator==(const EvidencePatch&, const EvidencePatch&) = default;
};

enum class CommandState : std::uint8_t {
  accepted = 1,
  refused = 2,
  superseded = 3,
  arrived = 4,
  stopped = 5,
  expired = 6,
  blocked = 7,  ///< Waits for a new path; `why` says what is in the way.
};

/// What became of a command. Resent until acknowledged.
struct CommandReport {
  std::uint64_t command = 0;
  std::uint32_t revision = 0;  ///< Of the path it speaks of.
  CommandState state = CommandState::accepted;
  std::string why;
  friend bool operator==(const CommandReport&, const CommandReport&) = default;
};

enum class CorridorWish : std::uint8_t {
  corridor = 1,  ///< More of the field, around where the robot is.
  plan = 2,      ///< The robot has to drive against the field: a new plan, if the map has changed.
};

/// What a robot lacks to go on by itself. Asked again while it does.
struct CorridorRequest {
  std::uint64_t command = 0;  ///< [Limit: ≠ 0]
  std::uint32_t revision = 0;
  std::int32_t x_mm = 0;  ///< Where it is.
  std::int32_t y_mm = 0;
  std::uint8_t half_width = 1;  ///< [cells] How wide. [Limit: 1 … kMaxCorridorHalfWidth]
  CorridorWish wish = CorridorWish::corridor;
  friend bool operator==(const CorridorRequest&, const CorridorRequest&) = default;
};

/// The session ends in good order.
struct Bye {
  friend bool operator==(const Bye&, const Bye&) = default;
};

/// What the robot holds of the long-term map in one region of kRegionTiles² tiles, for the server
/// to compare. Tiles that hold evidence of its own that the server does not have yet are left out.
struct MapDigest {
  struct Tile {
    std::uint8_t place = 0;  ///< (ty mod 4) · 4 + tx mod 4. [Limit: < 16, ascending]
    std::uint32_t digest = 0;
    friend bool operator==(const Tile&, const Tile&) = default;
  };
  bool last = false;  ///< At a session's beginning: nothing more is held.
  /// Of this boot's submaps those up to this one are in the tiles, no others.
  std::uint32_t holds_sequence = 0;
  std::int8_t level = 0;
  std::int32_t rx = 0;  ///< ⌊tx / 4⌋ [Limit: |rx| ≤ kMaxTileCoordinate / 4]
  std::int32_t ry = 0;
  std::vector<Tile> tiles;  ///< [Limit: ≤ 16]
  friend bool operator==(const MapDigest&, const MapDigest&) = default;
};
inline constexpr std::int32_t kRegionTiles = 4;

// ---- server → robot -------------------------------------------------------------------------

/// Answers Hello. `epoch` names the site's store: another epoch holds nothing of what an earlier
/// one acknowledged.
struct Welcome {
  std::uint32_t session = 0;  ///< [Limit: ≠ 0]
  std::uint64_t boot = 0;     ///< Echo, so that a late answer to an older Hello is recognised.
  std::uint64_t epoch = 0;
  friend bool operator==(const Welcome&, const Welcome&) = default;
};

enum class RejectReason : std::uint8_t {
  robot_id_in_use = 1,
  unknown_site = 2,
  cell_size_differs = 3,
  server_full = 4,
  bad_name = 5,
};

/// Answers Hello: no session.
struct Reject {
  std::uint64_t boot = 0;
  RejectReason reason = RejectReason::server_full;
  std::string text;
  friend bool operator==(const Reject&, const Reject&) = default;
};

/// "I do not know this session: say Hello."
struct Reset {
  friend bool operator==(const Reset&, const Reset&) = default;
};

/// "I hold version `held` of this block, which is older than your base": send from there.
struct Refusal {
  std::uint32_t sequence = 0;
  BlockKey key;
  std::uint32_t held = 0;
  friend bool operator==(const Refusal&, const Refusal&) = default;
};

/// "I do not have the common ground of this epoch": begin with an empty image.
struct GroundLost {
  std::uint8_t epoch = 0;
  friend bool operator==(const GroundLost&, const GroundLost&) = default;
};

enum class CommandKind : std::uint8_t { go_to = 1, stop = 2 };
enum class OnLinkLoss : std::uint8_t {
  proceed = 0,
  stop = 1,
  retrace = 2,  ///< Goes back along the way it came until the server is heard again; then stops.
};

/// What the operator wants, with its validity in the robot's own clock. Resent (with fresh times)
/// until reported on; `revision` counts new paths for the same goal.
struct Command {
  std::uint64_t id = 0;  ///< [Limit: ≠ 0] Greater than every earlier command to this robot.
  std::uint32_t revision = 0;
  CommandKind kind = CommandKind::stop;
  std::string issuer;
  std::uint64_t expires_clock_ms = 0;  ///< Robot's clock; after it the robot stops.
  OnLinkLoss on_link_loss = OnLinkLoss::stop;
  std::uint32_t link_timeout_ms = 0;  ///< Silence from the server that counts as link loss.
  std::uint64_t map_version = 0;      ///< Snapshot the path was planned on.
  std::int32_t goal_x_mm = 0;
  std::int32_t goal_y_mm = 0;
  /// [1e-4 rad] Turned to on the spot once the goal is reached; none: any will do.
  std::optional<std::int32_t> goal_yaw_1e4rad{};
  /// The path ends early, as it is too long to be sent at once: the robot asks for the rest.
  bool path_cut = false;
  std::uint16_t path_bytes = 0;  ///< In all parts. [Limit: ≤ kMaxPathBytes]
  friend bool operator==(const Command&, const Command&) = default;
};

/// Bytes of a command's path, from part · kPartBytes on.
struct PathPart {
  std::uint64_t command = 0;
  std::uint32_t revision = 0;
  std::uint8_t part = 0;            ///< [Limit: < kMaxPathBytes / kPartBytes]
  std::vector<std::uint8_t> bytes;  ///< [Limit: 1 … kPartBytes]
  friend bool operator==(const PathPart&, const PathPart&) = default;
};
inline constexpr std::size_t kMaxPathParts = kMaxPathBytes / kPartBytes;

/// The field in the cells around a stretch of way (see Corridor in core/planner/corridor.h), which
/// can be read without any other. The way is some points of the command's path, or one of its own:
/// from where the robot asked down the field.
struct CorridorPart {
  std::uint64_t command = 0;  ///< [Limit: ≠ 0]
  std::uint32_t revision = 0;
  std::uint64_t map_version = 0;  ///< Snapshot the field is of.
  std::uint16_t first = 0;        ///< Point of the path that it begins with.
  std::uint16_t count = 1;        ///< [points] [Limit: ≥ 1]
  std::uint8_t half_width = 1;    ///< [cells] [Limit: 1 … kMaxCorridorHalfWidth]
  /// Its own path, coded; none: the command's. [Limit: ≤ kMaxSpineBytes]
  std::vector<std::uint8_t> spine;
  std::vector<std::uint8_t> directions;  ///< [Limit: 1 … kMaxCorridorBytes]
  friend bool operator==(const CorridorPart&, const CorridorPart&) = default;
};

/// Blocks of one tile of the long-term map as they now are: a patch on an empty image. Cells that
/// it does not name are unknown. A tile comes whole, in all its blocks that hold something; one
/// that holds nothing comes as one block that names one unknown cell.
struct MapPatch {
  std::uint32_t step = 0;  ///< Of the commit it belongs to: a late copy is told by it. [Limit: ≥ 1]
  /// The submaps of this boot up to this one are folded into the tile.
  std::uint32_t holds_sequence = 0;
  std::vector<std::uint8_t> bytes;  ///< As in patch.h. [Limit: 1 … kMaxPatchBytes]
  friend bool operator==(const MapPatch&, const MapPatch&) = default;
};

/// Where the server's pose graph now has one of this boot's submaps.
struct SubmapMove {
  std::uint32_t step = 0;  ///< As in MapPatch.
  std::uint32_t sequence = 0;
  SubmapPose T_site_submap;
  friend bool operator==(const SubmapMove&, const SubmapMove&) = default;
};

/// The patches and moves of this step have all been acknowledged: use them at once.
struct MapCommit {
  std::uint32_t step = 0;     ///< Counts up from 1 in a session.
  std::uint32_t edition = 0;  ///< Counts the moves of this boot's submaps; 0 = never moved.
  friend bool operator==(const MapCommit&, const MapCommit&) = default;
};

// ---- both ways ------------------------------------------------------------------------------

/// Frames received: all up to `cumulative`, and cumulative + 2 + i for each set bit i. A robot's
/// frame is acknowledged only when everything in it is durable.
struct Ack {
  /// It was told before how long the newest frame waited here, or there is none.
  static constexpr std::uint16_t kDelayUnknown = 0xFFFF;
  std::uint32_t cumulative = 0;
  std::uint64_t bitmap = 0;
  /// [ms] How long the newest of them that asked for an acknowledgement waited for it, saturating.
  std::uint16_t delay_ms = 0;
  friend bool operator==(const Ack&, const Ack&) = default;
};

using Record =
    std::variant<Hello, PoseReport, SpoolReport, SubmapHead, EvidencePatch, CommandReport,
                 CorridorRequest, Bye, Welcome, Reject, Reset, Refusal, Command, PathPart,
                 CorridorPart, MapPatch, SubmapMove, MapCommit, GroundLost, MapDigest, Ack>;

}  // namespace cairn::proto
