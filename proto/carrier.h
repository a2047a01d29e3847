#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/common/result.h"

namespace cairn::proto {

/// [bytes] No frame is larger: with IP and carrier headers it stays below every usual MTU.
inline constexpr std::size_t kMaxFrameBytes = 1200;

/// A frame and who it came from or goes to. `peer` is the carrier's own name for the other end; a
/// robot has one peer and leaves it empty.
struct Datagram {
  std::string peer;
  std::vector<std::uint8_t> bytes;
};

/// Moves frames ≤ kMaxFrameBytes, best effort: they may be lost, doubled or reordered, never split.
/// send and receive may be called from different threads; each from one at a time.
class Carrier {
 public:
  Carrier() = default;
  virtual ~Carrier() = default;
  Carrier(const Carrier&) = delete;
  Carrier& operator=(const Carrier&) = delete;

  /// An error means the frame certainly did not leave; success promises nothing.
  virtual Status send(const Datagram& frame) = 0;
  /// The next frame, waiting at most `timeout`; nullopt when none came.
  virtual Result<std::optional<Datagram>> receive(std::chrono::milliseconds timeout) = 0;
  /// [bytes] What a frame costs on the wire beyond its own bytes (IP headers included).
  [[nodiscard]] virtual std::size_t overhead_bytes() const = 0;
  /// The robot's id that an end of this name has proven; nullopt where names of ends prove nothing
  /// and only tell them apart.
  [[nodiscard]] virtual std::optional<std::string> proven_robot(const std::string& /*peer*/) const {
    return std::nullopt;
  }
};

/// invalid_argument unless a frame of this size can travel.
[[nodiscard]] inline Status check_frame_size(std::size_t bytes) {
  if (bytes > 0 && bytes <= kMaxFrameBytes) return {};
  return Error{ErrorCode::invalid_argument,
               "a frame has 1 to 1200 bytes, not " + std::to_string(bytes) + ": split the content"};
}

}  // namespace cairn::proto
