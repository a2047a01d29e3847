#include "core/planner/wave.h"

namespace cairn {

Wave::Wave(const DrivableGrid& grid, Field& field)
    : grid_(grid),
      ground_(grid),
      field_(field),
      levelled_(field.levelled.data()),
      goal_(static_cast<std::uint32_t>(grid.ground_at(field.goal))),
      tilted_(grid.ground.one_way != 0.0),
      goal_effort_(grid.ground.one_way_effort(goal_)) {}

void Wave::radiate() {
  lower(goal_, 0);
  (void)run(std::numeric_limits<std::size_t>::max());
}

bool Wave::repair(const std::vector<std::uint32_t>& cells, std::vector<std::uint8_t>& doubted,
                  std::size_t most) {
  doubted_ = doubted.data();
  std::vector<std::pair<std::uint32_t, std::int32_t>> doubts;
  std::int32_t first = Field::kUnreached;
  const auto look_at = [&](std::uint32_t cell) {
    const std::int32_t cost = due(cell);
    if (cost >= Field::kUnreached) return;
    doubts.emplace_back(cell, cost);
    first = std::min(first, cost);
  };
  for (const std::uint32_t cell : cells) {
    look_at(cell);
    for (int d = 0; d < 8; ++d) look_at(cell + static_cast<std::uint32_t>(ground_.step(d)));
  }
  queue_.restart(first);
  for (const auto& [cell, cost] : doubts) doubt(cell, cost);
  if (run(most)) return true;
  std::fill(doubted.begin(), doubted.end(), std::uint8_t{0});
  return false;
}

bool Wave::run(std::size_t most) {
  WaveQueue::Entry entry;
  for (std::size_t looked_at = 0; queue_.pop(entry); ++looked_at) {
    if (looked_at == most) return false;
    if (entry.doubted) {
      settle_doubt(entry.cell);
    } else if (key(entry.cell, levelled_[entry.cell]) == entry.cost) {
      spread(entry.cell);
    }
  }
  return true;
}

/// [cost units] When a cell is to be looked at: at its cost or what that should be; kUnreached
/// when it is right as it is.
std::int32_t Wave::due(std::uint32_t cell) const {
  if (levelled_[cell] == Field::kClosed || is_goal(cell)) return Field::kUnreached;
  const std::int32_t now = ground_.cost_by_neighbours(levelled_, cell);
  const std::int32_t lower = std::min(now, levelled_[cell]);
  if (now == levelled_[cell] || lower >= Field::kUnreached) return Field::kUnreached;
  return key(cell, lower);
}

/// Once is enough for a cell's own cost.
void Wave::doubt(std::uint32_t cell, std::int32_t cost) {
  if (doubted_[cell] != 0) return;
  doubted_[cell] = 1;
  queue_.push({cell, cost, true});
}

void Wave::settle_doubt(std::uint32_t cell) {
  doubted_[cell] = 0;
  const std::int32_t now = ground_.cost_by_neighbours(levelled_, cell);
  if (now < levelled_[cell]) {
    lower(cell, now);
  } else if (now > levelled_[cell] && levelled_[cell] < Field::kUnreached) {
    raise(cell);
    if (now < Field::kUnreached) queue_.push({cell, key(cell, now), true});
  }
}

/// The cell has lost what its cost rested on; what may have rested on it is in doubt.
void Wave::raise(std::uint32_t cell) {
  const std::int32_t was = key(cell, levelled_[cell]);
  levelled_[cell] = Field::kUnreached;
  for (int d = 0; d < 8; ++d) {
    const std::uint32_t other = cell + static_cast<std::uint32_t>(ground_.step(d));
    if (levelled_[other] >= Field::kUnreached) continue;
    const std::int32_t cost = key(other, levelled_[other]);
    if (cost >= was + kLeastUnits) doubt(other, cost);
  }
}

void Wave::lower(std::uint32_t cell, std::int32_t levelled) {
  levelled_[cell] = levelled;
  if (doubted_ != nullptr) doubted_[cell] = 0;  // What waits came for an older, dearer cost.
  queue_.push({cell, key(cell, levelled), false});
}

void Wave::spread(std::uint32_t cell) {
  const std::int32_t least = key(cell, levelled_[cell]) + kLeastUnits;
  for (int d = 0; d < 8; ++d) {
    const std::uint32_t other = cell + static_cast<std::uint32_t>(ground_.step(d));
    if (levelled_[other] == Field::kClosed || key(other, levelled_[other]) <= least) continue;
    const std::int32_t now = ground_.cost_by_neighbours(levelled_, other);
    if (now < levelled_[other]) lower(other, now);
  }
}

}  // namespace cairn
