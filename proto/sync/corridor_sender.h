#pragma once

#include <cstdint>
#include <deque>

#include "proto/codec/frame.h"
#include "proto/codec/records.h"
#include "proto/sync/transit.h"

namespace cairn::proto {

/// The server's corridors around the way of one order, each sent until acknowledged, the first one
/// first.
class CorridorSender {
 public:
  /// [records] More are not taken: the robot asks when it needs them.
  static constexpr std::size_t kMaxParts = 8;

  /// Another order: what belongs to an older one need not be sent any more.
  void clear() { parts_.clear(); }
  void add(CorridorPart part);

  [[nodiscard]] bool has_news() const;
  /// Returns how many records were added.
  int fill(FrameWriter& frame, std::uint32_t number);
  void on_acked(std::uint32_t number);
  void on_lost(std::uint32_t number);

 private:
  struct Entry {
    CorridorPart part;
    Transit transit = {};
  };
  std::deque<Entry> parts_;  ///< Not acknowledged. [Limit: ≤ kMaxParts]
};

}  // namespace cairn::proto
