#pragma once

#include <cstdint>

#include "proto/codec/records.h"

namespace cairn::proto {

/// Receiver's record of which frame numbers to acknowledge: everything up to `cumulative` and a
/// window of 64 beyond. Numbers older than the window are treated as already acknowledged: a sender
/// never counts on a frame that lies so far back (Flight gives it up before).
class AckLog {
 public:
  /// Marks a frame as done (received; at the server: durable).
  void done(std::uint32_t number);
  /// Whether this number was already marked.
  [[nodiscard]] bool is_done(std::uint32_t number) const;
  [[nodiscard]] Ack ack() const { return ack_; }

 private:
  void slide(std::uint64_t by);  ///< Everything up to cumulative + by counts as done.

  Ack ack_;
};

}  // namespace cairn::proto
