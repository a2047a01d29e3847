#include "proto/codec/record_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "proto/codec/bytes.h"
#include "tests/support/sample_records.h"

namespace cairn::proto {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Encoded {
  std::uint8_t type;
  Direction direction;
  Bytes body;
};

Encoded encoded(const std::string& name) {
  for (const auto& sample : testing::sample_records()) {
    if (sample.name != name) continue;
    Bytes bytes;
    append_record(bytes, sample.record);
    return {bytes[0], sample.direction, Bytes(bytes.begin() + kRecordHeaderBytes, bytes.end())};
  }
  ADD_FAILURE() << "no sample " << name;
  return {};
}

/// A sample record with some bytes of its body replaced, and which field must be complained of.
struct Breach {
  std::string rule;
  std::string record;
  std::size_t at;
  Bytes bytes;
  std::string complaint;
};

void PrintTo(const Breach& breach, std::ostream* out) { *out << breach.rule; }

Bytes i32(std::int32_t value) {
  Bytes out;
  ByteWriter(out).put(value);
  return out;
}
Bytes zeros(std::size_t count) { return Bytes(count, 0); }
std::vector<std::uint8_t> ones(std::size_t count) { return std::vector<std::uint8_t>(count, 0xFF); }

const Bytes kTooFar = i32(kMaxCoordinateMm + 1);
const Bytes kTooFarWest = i32(-kMaxCoordinateMm - 1);
const Bytes kTooManyTiles = i32(kMaxTileCoordinate + 1);
const Bytes kTooFewTiles = i32(-kMaxTileCoordinate - 1);

const std::vector<Breach> kBreaches = {
    {"RobotNameHasOnlyPlainLetters", "hello", 1, {'R'}, "hello: robot"},
    {"RobotNameIsNotEmpty", "hello", 0, {0}, "hello: robot"},
    {"SiteNameHasOnlyPlainLetters", "hello", 9, {'/'}, "hello: site"},
    {"SiteNameEndsInsideTheRecord", "hello", 8, {255}, "hello: site"},
    {"CellsAreAtLeastTenMillimetres", "hello", 23, {9, 0}, "hello: cell size"},
    {"CellsAreAtMostTwoMetres", "hello", 23, {0xD1, 0x07}, "hello: cell size"},
    {"PoseClockIsANumber", "pose_report", 0, ones(11), "pose report: clock"},
    {"PoseClockIsNotLongerThanNeeded", "pose_report", 0, {0xC0, 0x80, 0x00}, "pose report: clock"},
    {"PoseXIsBounded", "pose_report", 3, {0x82, 0x84, 0xAF, 0x5F}, "pose report: x"},
    {"PoseYIsBounded", "pose_report", 6, {0x81, 0x84, 0xAF, 0x5F}, "pose report: y"},
    {"PoseZIsBounded", "pose_report", 8, {0x82, 0x84, 0xAF, 0x5F}, "pose report: z"},
    {"PoseYawIsBounded", "pose_report", 10, {0xF2, 0xEA, 0x03}, "pose report: yaw"},
    {"PoseYawIsBoundedBelow", "pose_report", 10, {0xF1, 0xEA, 0x03}, "pose report: yaw"},
    {"DriveStateIsKnown", "pose_report", 20, {4}, "pose report: drive state"},
    {"LocalizationIsKnown", "pose_report", 21, {3}, "pose report: localization"},
    {"HeadVersionsBeginAtOne", "submap_head", 4, zeros(4), "submap head: version"},
    {"HeadXIsBounded", "submap_head", 8, kTooFar, "submap head: x"},
    {"HeadYawIsBounded", "submap_head", 20, i32(40000), "submap head: yaw"},
    {"ClosedIsAFlag", "submap_head", 24, {2}, "submap head: closed"},
    {"HeadBlocksAreBounded", "submap_head", 25, i32(65537), "submap head: blocks"},
    {"AnOpenHeadHasNoFinalVersions", "submap_head", 24, {0}, "submap head: final versions"},
    {"EveryBlockHasAVersion", "submap_head", 29, zeros(8), "submap head: final versions"},
    {"FramesBackAreBounded", "evidence_patch", 7, {33}, "evidence patch: back"},
    {"FramesBackAreEarlierOnes", "evidence_patch", 9, {0}, "evidence patch: back"},
    {"ReportNamesACommand", "command_report", 0, zeros(8), "command report: command"},
    {"ReportStateIsNotZero", "command_report", 12, {0}, "command report: state"},
    {"ReportStateIsKnown", "command_report", 12, {8}, "command report: state"},
    {"ReportTextHasNoControlCharacters", "command_report", 14, {'\n'}, "command report: why"},
    {"ReportTextIsUtf8", "command_report", 14, {0xFF}, "command report: why"},
    {"WelcomeNamesASession", "welcome", 0, zeros(4), "welcome: session"},
    {"RejectReasonIsNotZero", "reject", 8, {0}, "reject: reason"},
    {"RejectReasonIsKnown", "reject", 8, {6}, "reject: reason"},
    {"RejectTextHasNoControlCharacters", "reject", 10, {0x1B}, "reject: text"},
    {"RefusalLayerIsKnown", "refusal", 4, {9}, "refusal: layer"},
    {"RefusalTileXIsBounded", "refusal", 6, kTooManyTiles, "refusal: tx"},
    {"RefusalTileYIsBounded", "refusal", 10, kTooFewTiles, "refusal: ty"},
    {"RefusalBlockIsBounded", "refusal", 14, {16}, "refusal: block"},
    {"CommandHasAnId", "command", 0, zeros(8), "command: id"},
    {"CommandKindIsNotZero", "command", 12, {0}, "command: kind"},
    {"CommandKindIsKnown", "command", 12, {3}, "command: kind"},
    {"IssuerHasNoControlCharacters", "command", 14, {0x7F}, "command: issuer"},
    {"LinkLossChoiceIsKnown", "command", 25, {3}, "command: on link loss"},
    {"GoalXIsBounded", "command", 38, kTooFar, "command: goal x"},
    {"GoalYIsBounded", "command", 42, kTooFarWest, "command: goal y"},
    {"GoalYawIsBounded", "command", 47, i32(31417), "command: goal yaw"},
    {"GoalYawIsBoundedBelow", "command", 47, i32(-31417), "command: goal yaw"},
    {"HasHeadingIsAFlag", "command", 46, {2}, "command: goal yaw"},
    {"PathCutIsAFlag", "command", 51, {2}, "command: path cut"},
    {"PathIsBounded", "command", 52, {0xA1, 0x0F}, "command: path bytes"},
    {"PartNamesACommand", "path_part", 0, zeros(8), "path part: command"},
    {"PartsAreBounded", "path_part", 12, {4}, "path part: part"},
    {"CorridorNamesACommand", "corridor_part", 0, zeros(8), "corridor part: command"},
    {"CorridorHasAPoint", "corridor_part", 22, zeros(2), "corridor part: count"},
    {"CorridorHasAWidth", "corridor_part", 24, {0}, "corridor part: half width"},
    {"CorridorWidthIsBounded", "corridor_part", 24, {65}, "corridor part: half width"},
    {"CorridorsPathIsBounded", "corridor_part_own", 25, {201}, "corridor part: spine"},
    {"CorridorsPathEndsInsideTheRecord", "corridor_part_own", 25, {11}, "corridor part: spine"},
    {"CorridorHasDirections", "corridor_part_own", 25, {10}, "corridor part: directions"},
    {"RequestNamesACommand", "corridor_request", 0, zeros(8), "corridor request: command"},
    {"RequestXIsBounded", "corridor_request", 12, kTooFar, "corridor request: x"},
    {"RequestYIsBounded", "corridor_request", 16, kTooFarWest, "corridor request: y"},
    {"RequestHasAWidth", "corridor_request", 20, {0}, "corridor request: half width"},
    {"RequestWidthIsBounded", "corridor_request", 20, {65}, "corridor request: half width"},
    {"WishIsNotZero", "corridor_request", 21, {0}, "corridor request: wish"},
    {"WishIsKnown", "corridor_request", 21, {3}, "corridor request: wish"},
    {"MapPatchHasAStep", "map_patch", 0, zeros(4), "map patch: step"},
};

class RecordRule : public ::testing::TestWithParam<Breach> {};

TEST_P(RecordRule, IsCheckedOnReading) {
  const Breach& breach = GetParam();
  Encoded sample = encoded(breach.record);
  ASSERT_TRUE(read_record(sample.type, sample.body, sample.direction));
  ASSERT_LE(breach.at + breach.bytes.size(), sample.body.size());
  std::ranges::copy(breach.bytes, sample.body.begin() + static_cast<std::ptrdiff_t>(breach.at));
  const auto record = read_record(sample.type, sample.body, sample.direction);
  ASSERT_FALSE(record);
  EXPECT_NE(record.error().message.find(breach.complaint + " "), std::string::npos)
      << record.error().message;
}

INSTANTIATE_TEST_SUITE_P(Every, RecordRule, ::testing::ValuesIn(kBreaches),
                         [](const auto& test) { return test.param.rule; });

TEST(RecordCodec, EveryRecordIsRefusedFromTheWrongEnd) {
  for (const auto& sample : testing::sample_records()) {
    const Encoded good = encoded(sample.name);
    const auto other = good.direction == Direction::up ? Direction::down : Direction::up;
    const bool both_ways = std::holds_alternative<Ack>(sample.record);
    EXPECT_EQ(read_record(good.type, good.body, other).has_value(), both_ways) << sample.name;
  }
}

TEST(RecordCodec, EveryRecordIsRefusedWithAByteMoreOrLess) {
  for (const auto& sample : testing::sample_records()) {
    // What is inside tells where these end.
    if (sample.name.ends_with("_patch") || sample.name.starts_with("corridor_part")) continue;
    if (sample.name == "path_part") continue;
    Encoded good = encoded(sample.name);
    good.body.push_back(0);
    EXPECT_FALSE(read_record(good.type, good.body, good.direction)) << sample.name;
    good.body.pop_back();
    if (good.body.empty()) continue;
    good.body.pop_back();
    EXPECT_FALSE(read_record(good.type, good.body, good.direction)) << sample.name;
  }
}

TEST(RecordCodec, UnknownTypesAreRefused) {
  const std::vector<unsigned> known = {1,  2,  3,  4,  5,  6,  7,  16, 17, 18,
                                       19, 20, 21, 22, 23, 24, 25, 26, 31, 32};
  for (unsigned type = 0; type < 256; ++type) {
    if (std::ranges::find(known, type) != known.end()) continue;
    for (const Direction direction : {Direction::up, Direction::down}) {
      EXPECT_FALSE(read_record(static_cast<std::uint8_t>(type), {}, direction)) << type;
    }
  }
}

}  // namespace
}  // namespace cairn::proto
