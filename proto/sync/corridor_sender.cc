#include "proto/sync/corridor_sender.h"

#include <algorithm>
#include <utility>

namespace cairn::proto {

void CorridorSender::add(CorridorPart part) {
  if (parts_.size() < kMaxParts) parts_.push_back({.part = std::move(part)});
}

bool CorridorSender::has_news() const {
  return std::ranges::any_of(parts_, [](const Entry& entry) { return entry.transit.waits(); });
}

int CorridorSender::fill(FrameWriter& frame, std::uint32_t number) {
  int added = 0;
  for (Entry& entry : parts_) {
    if (!entry.transit.waits() || !frame.add(entry.part)) continue;
    entry.transit.sent(number);
    ++added;
  }
  return added;
}

void CorridorSender::on_acked(std::uint32_t number) {
  for (Entry& entry : parts_) entry.transit.on_acked(number);
  std::erase_if(parts_, [](const Entry& entry) { return entry.transit.acknowledged(); });
}

void CorridorSender::on_lost(std::uint32_t number) {
  for (Entry& entry : parts_) entry.transit.on_lost(number);
}

}  // namespace cairn::proto
