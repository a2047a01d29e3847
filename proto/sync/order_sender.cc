#include "proto/sync/order_sender.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace cairn::proto {

void OrderSender::set(Command command, const std::vector<std::uint8_t>& path,
                      MonotonicTime expires_at) {
  assert(path.size() <= kMaxPathBytes);
  *this = {};
  command.path_bytes = static_cast<std::uint16_t>(path.size());
  for (std::size_t first = 0; first < path.size(); first += kPartBytes) {
    const std::size_t count = std::min(kPartBytes, path.size() - first);
    const auto begin = path.begin() + static_cast<std::ptrdiff_t>(first);
    Part part;
    part.part = {.command = command.id,
                 .revision = command.revision,
                 .part = static_cast<std::uint8_t>(first / kPartBytes),
                 .bytes = {begin, begin + static_cast<std::ptrdiff_t>(count)}};
    parts_.push_back(std::move(part));
  }
  command_ = std::move(command);
  expires_at_ = expires_at;
}

void OrderSender::on_report(const CommandReport& report) {
  const bool ours =
      command_ && report.command == command_->id && report.revision == command_->revision;
  if (ours) *this = {};
}

void OrderSender::ask_again_if_due(MonotonicTime now) {
  const auto due = ask_due();
  if (!due || now < *due) return;
  record_.again();
  ask_wait_ = std::min(2 * ask_wait_, kMostAskWait);
}

std::optional<MonotonicTime> OrderSender::ask_due() const {
  if (!command_ || !all_acknowledged()) return std::nullopt;
  return asked_at_ + ask_wait_;
}

bool OrderSender::has_news() const {
  if (!command_) return false;
  return record_.waits() ||
         std::ranges::any_of(parts_, [](const Part& part) { return part.transit.waits(); });
}

bool OrderSender::fill_command(FrameWriter& frame, std::uint32_t number,
                               std::uint64_t expires_clock_ms, MonotonicTime now) {
  if (!record_waits()) return false;
  command_->expires_clock_ms = expires_clock_ms;
  if (!frame.add(*command_)) return false;
  record_.sent(number);
  asked_at_ = now;
  if (command_->path_bytes <= kShortPath) (void)fill_parts(frame, number);
  return true;
}

bool OrderSender::fill_parts(FrameWriter& frame, std::uint32_t number) {
  bool added = false;
  for (Part& part : parts_) {
    if (!part.transit.waits() || !frame.add(part.part)) continue;
    part.transit.sent(number);
    added = true;
  }
  return added;
}

void OrderSender::on_acked(std::uint32_t number) {
  record_.on_acked(number);
  for (Part& part : parts_) part.transit.on_acked(number);
}

void OrderSender::on_lost(std::uint32_t number) {
  record_.on_lost(number);
  for (Part& part : parts_) part.transit.on_lost(number);
}

bool OrderSender::all_acknowledged() const {
  return record_.acknowledged() &&
         std::ranges::all_of(parts_, [](const Part& part) { return part.transit.acknowledged(); });
}

}  // namespace cairn::proto
