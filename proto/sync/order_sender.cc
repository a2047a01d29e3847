#include "proto/sync/order_sender.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace cairn::proto {

void OrderSender::set(Command command, const std::vector<PathPart::Point>& path,
                      MonotonicTime expires_at) {
  assert(path.size() <= kMaxPathPoints);
  *this = {};
  command.path_points = static_cast<std::uint16_t>(path.size());
  for (std::size_t first = 0; first < path.size(); first += kMaxPartPoints) {
    const std::size_t count = std::min(kMaxPartPoints, path.size() - first);
    const auto begin = path.begin() + static_cast<std::ptrdiff_t>(first);
    Part part;
    part.part = {.command = command.id,
                 .revision = command.revision,
                 .first = static_cast<std::uint16_t>(first),
                 .points = {begin, begin + static_cast<std::ptrdiff_t>(count)}};
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
  record_.where = Where::waiting;
  ask_wait_ = std::min(2 * ask_wait_, kMostAskWait);
}

std::optional<MonotonicTime> OrderSender::ask_due() const {
  if (!command_ || !all_acknowledged()) return std::nullopt;
  return asked_at_ + ask_wait_;
}

bool OrderSender::has_news() const {
  if (!command_) return false;
  const auto waits = [](const Item& item) { return item.where == Where::waiting; };
  return waits(record_) || std::ranges::any_of(parts_, waits);
}

bool OrderSender::fill_command(FrameWriter& frame, std::uint32_t number,
                               std::uint64_t expires_clock_ms, MonotonicTime now) {
  if (!command_ || record_.where != Where::waiting) return false;
  command_->expires_clock_ms = expires_clock_ms;
  if (!frame.add(*command_)) return false;
  record_ = {.where = Where::under_way, .carrier = number};
  asked_at_ = now;
  return true;
}

bool OrderSender::fill_parts(FrameWriter& frame, std::uint32_t number) {
  bool added = false;
  for (Part& part : parts_) {
    if (part.where != Where::waiting || !frame.add(part.part)) continue;
    part.where = Where::under_way;
    part.carrier = number;
    added = true;
  }
  return added;
}

void OrderSender::on_acked(std::uint32_t number) { move(number, Where::acknowledged); }

void OrderSender::on_lost(std::uint32_t number) { move(number, Where::waiting); }

void OrderSender::move(std::uint32_t number, Where to) {
  if (in_frame(record_, number)) record_.where = to;
  for (Part& part : parts_) {
    if (in_frame(part, number)) part.where = to;
  }
}

bool OrderSender::in_frame(const Item& item, std::uint32_t number) {
  return item.where == Where::under_way && item.carrier == number;
}

bool OrderSender::all_acknowledged() const {
  const auto acknowledged = [](const Item& item) { return item.where == Where::acknowledged; };
  return acknowledged(record_) && std::ranges::all_of(parts_, acknowledged);
}

}  // namespace cairn::proto
