#pragma once

#include <string>
#include <variant>
#include <vector>

#include "proto/codec/frame.h"
#include "proto/codec/patch.h"

/// One fixed record of each kind, and equality that knows which cells of a block mean anything.
namespace cairn::proto::testing {

inline BlockUpdate sample_block() {
  BlockUpdate update{.sequence = 7, .key = {}, .base = 3, .version = 5, .delta = {}};
  update.key = {EvidenceLayer::seen_through, {0, -2, 5}, 11};
  update.delta.datum_mm = -4000;
  update.delta.changed.set(0).set(17).set(18).set(255);
  update.delta.cells[0] = {-3990, 200};
  update.delta.cells[17] = {0, 0};
  update.delta.cells[18] = {-4900, 1};
  update.delta.cells[255] = {28'000, 255};
  return update;
}

/// `sample_block` on an empty image.
inline std::vector<std::uint8_t> sample_patch() {
  const BlockUpdate block = sample_block();
  return write_patch({&block, 1}, {7, 201}, {}, {}, kMaxPatchBytes).bytes;
}

inline PoseReport sample_pose() {
  return {.clock_ms = 123'456,
          .T_site_robot = {12'345, -2'000, 150, -15'708},
          .roll_1e4rad = -100,
          .pitch_1e4rad = 350,
          .sigma_mm = 42,
          .speed_mm_s = 480,
          .drive = DriveState::driving,
          .localization = Localization::unsure,
          .command = 9,
          .to_go_mm = 17'500,
          .backlog_blocks = 33};
}

inline Command sample_command() {
  return {.id = 9,
          .revision = 2,
          .kind = CommandKind::go_to,
          .issuer = "Ada",
          .expires_clock_ms = 183'456,
          .on_link_loss = OnLinkLoss::proceed,
          .link_timeout_ms = 5'000,
          .map_version = 77,
          .goal_x_mm = 30'000,
          .goal_y_mm = -8'000,
          .goal_yaw_1e4rad = -15'708,
          .path_cut = true,
          .path_bytes = 9};
}

/// From (10, 0) to (30, -8) m in cells of 125 mm, as core/planner/corridor.h codes it.
inline std::vector<std::uint8_t> sample_path() {
  return {0x7D, 0x02, 0x80, 0x05, 0x00, 0x0B, 0x00, 0xFD, 0x0F};
}

/// Name (as in the golden files), who sends it, and the record.
struct Sample {
  std::string name;
  Direction direction;
  Record record;
};

inline std::vector<Sample> sample_records() {
  const auto up = Direction::up;
  const auto down = Direction::down;
  const SubmapLink link{{8'010, -30, 5, 120}, 45, 12, 60};
  const SubmapHead head{7, 2, {1'000, -1'000, 20, 15'708}, true, 12, 40, 3, link};
  const SubmapHead earlier{0x80000003, 3,  {1'000, -1'000, 20, 15'708}, true, 0, 0,
                           3,          {}, SubmapId{0x99AABBCC, 7}};
  return {
      {"hello", up, Hello{"rover-1", "quarry", 0x1122334455667788, 125, 1'000}},
      {"pose_report", up, sample_pose()},
      {"map_digest", up, MapDigest{true, 7, 0, -1, 2, {{3, 0xA1B2C3D4}, {12, 5}}}},
      {"spool_report", up, SpoolReport{true, 12, 3'456'789, 5, 2}},
      {"submap_head", up, head},
      {"submap_head_earlier", up, earlier},
      {"evidence_patch", up, EvidencePatch{7, 201, {1, 250, {9, 3, 2}}, sample_patch()}},
      {"command_report", up, CommandReport{9, 2, CommandState::stopped, "tilt 31°"}},
      {"corridor_request", up, CorridorRequest{9, 2, 12'345, -2'000, 40, CorridorWish::plan}},
      {"bye", up, Bye{}},
      {"welcome", down, Welcome{0xA1B2C3D4, 0x1122334455667788, 0x0102030405060708}},
      {"reject", down, Reject{0x1122334455667788, RejectReason::unknown_site, "no such site"}},
      {"reset", down, Reset{}},
      {"refusal", down, Refusal{7, {EvidenceLayer::surface, {0, 1, -1}, 4}, 2}},
      {"command", down, sample_command()},
      {"path_part", down, PathPart{9, 2, 0, sample_path()}},
      {"corridor_part", down, CorridorPart{9, 2, 77, 0, 2, 12, {}, {0x5A, 0x00, 0xC3}}},
      {"corridor_part_own", down, CorridorPart{9, 2, 78, 1, 2, 40, sample_path(), {0x17}}},
      {"map_patch", down, MapPatch{3, 7, sample_patch()}},
      {"submap_move", down, SubmapMove{3, 7, {1'040, -980, 25, 15'720}}},
      {"map_commit", down, MapCommit{3, 2}},
      {"ground_lost", down, GroundLost{1}},
      {"ack_up", up, Ack{300, 0x5, 40}},
      {"ack_down", down, Ack{41, 0x8000000000000000, 40}},
  };
}

inline std::vector<std::uint8_t> frame_of(const Sample& sample) {
  FrameWriter frame({.direction = sample.direction, .session = 0x01020304, .number = 5});
  frame.add(sample.record);
  return std::move(frame).finish();
}

inline bool same_delta(const BlockDelta& a, const BlockDelta& b) {
  if (a.datum_mm != b.datum_mm || a.changed != b.changed) return false;
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    const bool both_unknown = !a.cells.at(i).known() && !b.cells.at(i).known();
    if (a.changed[i] && !both_unknown && a.cells.at(i) != b.cells.at(i)) return false;
  }
  return true;
}

inline bool same(const BlockUpdate& a, const BlockUpdate& b) {
  return a.sequence == b.sequence && a.key == b.key && a.base == b.base && a.version == b.version &&
         same_delta(a.delta, b.delta);
}
template <class R>
bool same(const R& a, const R& b) {
  return a == b;
}
inline bool same(const Record& a, const Record& b) {
  return a.index() == b.index() &&
         std::visit([&b]<class R>(const R& r) { return same(r, std::get<R>(b)); }, a);
}

}  // namespace cairn::proto::testing
