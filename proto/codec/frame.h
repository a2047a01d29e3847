#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/common/result.h"
#include "proto/carrier.h"
#include "proto/codec/records.h"

namespace cairn::proto {

inline constexpr std::uint8_t kProtocolVersion = 6;
inline constexpr std::size_t kFrameHeaderBytes = 12;
inline constexpr std::size_t kChecksumBytes = 4;
/// Bounds what a frame can make the receiver allocate …
inline constexpr std::size_t kMaxFrameRecords = 64;
/// … and how much work its patches can make (kMaxPatchBlocks and kMaxPatchCells each).
inline constexpr std::size_t kMaxFramePatches = 4;

enum class Direction : std::uint8_t { up = 0, down = 1 };  ///< up: robot → server.

struct FrameHeader {
  Direction direction = Direction::up;
  std::uint32_t session = 0;  ///< 0 before Welcome.
  std::uint32_t number = 0;   ///< Counts up from 1 in each direction of a session.
  friend bool operator==(const FrameHeader&, const FrameHeader&) = default;
};

struct Frame {
  FrameHeader header;
  std::vector<Record> records;
};

/// Fills one frame record by record.
class FrameWriter {
 public:
  explicit FrameWriter(FrameHeader header);
  /// False, changing nothing, when the record does not fit any more. Texts are cut to their bound.
  /// Requires: every other field within its bounds.
  bool add(const Record& record);
  [[nodiscard]] bool empty() const { return records_ == 0; }
  /// [bytes] Of the finished frame.
  [[nodiscard]] std::size_t size_bytes() const { return bytes_.size() + kChecksumBytes; }
  /// [bytes] Room for the body of one more record; 0 when none fits.
  [[nodiscard]] std::size_t room_bytes() const;
  /// Closes the frame with its checksum.
  [[nodiscard]] std::vector<std::uint8_t> finish() &&;

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t records_ = 0;
  std::size_t patches_ = 0;
};

/// Reads a whole frame or says what is wrong with it: magic, version, direction, checksum, every
/// record's length, enum and bound. Never reads outside, never allocates for more than
/// kMaxFrameRecords records. Patches are not looked into.
[[nodiscard]] Result<Frame> decode_frame(std::span<const std::uint8_t> bytes,
                                         Direction expected_direction);

/// What of a frame a carrier that knows its ends and finds damage itself must carry: all but magic,
/// version, direction and checksum. Nullopt for what is no sound frame of a session: that is
/// carried whole, so that an end that speaks another version can say so.
[[nodiscard]] std::optional<std::span<const std::uint8_t>> bare_frame(
    std::span<const std::uint8_t> frame, Direction direction);
/// The whole frame again.
[[nodiscard]] std::vector<std::uint8_t> whole_frame(std::span<const std::uint8_t> bare,
                                                    Direction direction);
/// [bytes] That a bare frame lacks.
inline constexpr std::size_t kFrameEndsBytes = 4 + kChecksumBytes;

/// CRC-32C (Castagnoli) as in iSCSI; CRC of "123456789" is 0xE3069283.
[[nodiscard]] std::uint32_t crc32c(std::span<const std::uint8_t> bytes);

}  // namespace cairn::proto
