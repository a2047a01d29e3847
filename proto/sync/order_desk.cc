#include "proto/sync/order_desk.h"

#include <algorithm>

namespace cairn::proto {

OrderDesk::Outcome OrderDesk::on_command(const Command& command) {
  const Key key{command.id, command.revision};
  if (command.id < newest_.first) return {.order = {}, .superseded = key, .asked_again = {}};
  if (key < newest_) return {};  // An old revision that was under way for long.
  begin_if_newer(key);
  if (handed_out_) return {.order = {}, .superseded = {}, .asked_again = key};
  command_ = command;
  return hand_out_if_complete();
}

OrderDesk::Outcome OrderDesk::on_part(const PathPart& part) {
  const Key key{part.command, part.revision};
  if (key < newest_) return {};
  begin_if_newer(key);
  const std::size_t end = part.first + part.points.size();
  if (handed_out_ || end > kMaxPathPoints) return {};
  if (points_.size() < end) points_.resize(end);
  std::ranges::copy(part.points, points_.begin() + part.first);
  for (std::size_t i = part.first; i < end; ++i) have_.set(i);
  return hand_out_if_complete();
}

void OrderDesk::forget() { *this = {}; }

void OrderDesk::begin_if_newer(const Key& key) {
  if (key <= newest_) return;
  *this = {};
  newest_ = key;
}

OrderDesk::Outcome OrderDesk::hand_out_if_complete() {
  if (handed_out_ || !complete()) return {};
  handed_out_ = true;
  points_.resize(command_->path_points);
  return {.order = Order{*command_, std::move(points_)}, .superseded = {}, .asked_again = {}};
}

bool OrderDesk::complete() const {
  if (!command_) return false;
  for (std::size_t i = 0; i < command_->path_points; ++i) {
    if (!have_[i]) return false;
  }
  return true;
}

}  // namespace cairn::proto
