#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "proto/dds/entity.h"

namespace cairn::proto {

/// Robots → server and server → robots. Two topics, so that robots never hear each other.
inline constexpr const char* kUpTopic = "cairn/up";
inline constexpr const char* kDownTopic = "cairn/down";

/// [bytes] IP 20, UDP 8, RTPS 20, INFO_TS 12, DATA 24, CDR header 4; then the sequence's length.
inline constexpr std::size_t kDdsOverheadBytes = 88 + 4;

[[nodiscard]] Result<DdsEntity> create_frame_topic(dds_entity_t participant, const char* name);

/// The frames written to a topic within one partition ("*": all).
class FrameReader {
 public:
  /// `depth`: frames kept while nobody reads; then the oldest is lost.
  static Result<FrameReader> create(dds_entity_t participant, dds_entity_t topic,
                                    const std::string& partition, int depth);

  struct Taken {
    std::vector<std::uint8_t> bytes;
    dds_instance_handle_t publication = 0;  ///< The writer it came from.
  };
  /// The next frame, if any is here.
  Result<std::optional<Taken>> take();
  /// Returns when a frame is here, the matched writers changed, or `timeout` is over.
  Status wait(std::chrono::nanoseconds timeout);

  /// Whether writers came or went since the last call.
  bool writers_changed();
  /// At most `limit` of the matched writers.
  [[nodiscard]] std::vector<dds_instance_handle_t> writers(std::size_t limit) const;
  /// The partition a matched writer writes to; nullopt when it is gone or has not exactly one.
  [[nodiscard]] std::optional<std::string> partition_of(dds_instance_handle_t publication) const;

 private:
  FrameReader() = default;

  DdsEntity subscriber_;
  DdsEntity reader_;
  DdsEntity condition_;
  DdsEntity waitset_;
};

/// Writes frames to a topic within one partition.
class FrameTopicWriter {
 public:
  static Result<FrameTopicWriter> create(dds_entity_t participant, dds_entity_t topic,
                                         const std::string& partition);
  /// Whether any reader is known; without one a frame would go nowhere.
  [[nodiscard]] bool has_reader() const;
  Status write(std::span<const std::uint8_t> bytes);

 private:
  FrameTopicWriter() = default;

  DdsEntity publisher_;
  DdsEntity writer_;
};

}  // namespace cairn::proto
