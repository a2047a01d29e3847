#include "proto/sync/order_desk.h"

#include <utility>

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
  if (handed_out_) return {};
  parts_.at(part.part) = part.bytes;
  return hand_out_if_complete();
}

void OrderDesk::on_corridor(const CorridorPart& corridor) {
  const Key key{corridor.command, corridor.revision};
  if (key < newest_) return;
  begin_if_newer(key);
  if (corridors_.size() < kMaxCorridors) corridors_.push_back(corridor);
}

std::vector<CorridorPart> OrderDesk::take_corridors() {
  return handed_out_ ? std::exchange(corridors_, {}) : std::vector<CorridorPart>();
}

void OrderDesk::forget() { *this = {}; }

void OrderDesk::begin_if_newer(const Key& key) {
  if (key <= newest_) return;
  *this = {};
  newest_ = key;
}

OrderDesk::Outcome OrderDesk::hand_out_if_complete() {
  if (handed_out_ || !command_) return {};
  auto path = whole_path();
  if (!path) return {};
  handed_out_ = true;
  parts_ = {};
  return {.order = Order{*command_, *std::move(path)}, .superseded = {}, .asked_again = {}};
}

std::optional<std::vector<std::uint8_t>> OrderDesk::whole_path() const {
  std::vector<std::uint8_t> path;
  for (std::size_t i = 0; path.size() < command_->path_bytes; ++i) {
    if (i == parts_.size() || parts_.at(i).empty()) return std::nullopt;
    path.insert(path.end(), parts_.at(i).begin(), parts_.at(i).end());
  }
  return path;
}

}  // namespace cairn::proto
