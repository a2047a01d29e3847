#pragma once

#include <cstdint>
#include <optional>

#include "core/common/time.h"
#include "proto/codec/records.h"

namespace cairn::proto {

/// Receiver's record of which frame numbers to acknowledge: everything up to `cumulative` and a
/// window of 64 beyond. Numbers older than the window are treated as already acknowledged: a sender
/// never counts on a frame that lies so far back (Flight gives it up before).
class AckLog {
 public:
  /// Marks a frame as done (received; at the server: durable). `arrived`: when it did, for one that
  /// asks for an acknowledgement.
  void done(std::uint32_t number, std::optional<MonotonicTime> arrived = {});
  /// Whether this number was already marked.
  [[nodiscard]] bool is_done(std::uint32_t number) const;
  /// The acknowledgement to be sent now. Tells the delay of each newest frame once: what repeats a
  /// lost acknowledgement says nothing about the link.
  [[nodiscard]] Ack tell(MonotonicTime now);
  /// The same without a delay.
  [[nodiscard]] const Ack& ack() const { return ack_; }

 private:
  void slide(std::uint64_t by);  ///< Everything up to cumulative + by counts as done.

  Ack ack_{.delay_ms = Ack::kDelayUnknown};
  std::uint32_t newest_ = 0;              ///< That asked for an acknowledgement.
  std::optional<MonotonicTime> arrived_;  ///< When it did, until that was told.
};

}  // namespace cairn::proto
