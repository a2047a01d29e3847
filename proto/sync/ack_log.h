#pragma once

#include <cstdint>

#include "proto/codec/records.h"

namespace cairn::proto {

/// Receiver's record of which frame numbers to acknowledge: everything up to `cumulative` and a
/// window of 64 beyond. Numbers older than the window are treated as already acknowledged.
class AckLog {
 public:
  /// Marks a frame as done (received; at the server: durable).
  void done(std::uint32_t number);
  /// Whether this number was already marked.
  [[nodiscard]] bool is_done(std::uint32_t number) const;
  [[nodiscard]] Ack ack() const { return ack_; }

 private:
  Ack ack_;
};

}  // namespace cairn::proto
