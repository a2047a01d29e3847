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
  run();
}

void Wave::repair(const std::vector<std::uint32_t>& cells) {
  for (const std::uint32_t cell : cells) {
    doubt(cell);
    for (int d = 0; d < 8; ++d) doubt(cell + static_cast<std::uint32_t>(ground_.step(d)));
  }
  run();
}

void Wave::run() {
  WaveQueue::Entry entry;
  while (queue_.pop(entry)) {
    if (entry.doubted) {
      settle_doubt(entry.cell);
    } else if (key(entry.cell, levelled_[entry.cell]) == entry.cost) {
      spread(entry.cell);
    }
  }
}

/// Into the queue where its cost, or what it would cost, is due.
void Wave::doubt(std::uint32_t cell) {
  if (levelled_[cell] == Field::kClosed || is_goal(cell)) return;
  const std::int32_t now = ground_.cost_by_neighbours(levelled_, cell);
  const std::int32_t due = std::min(now, levelled_[cell]);
  if (now == levelled_[cell] || due >= Field::kUnreached) return;
  queue_.push({cell, key(cell, due), true});
}

void Wave::settle_doubt(std::uint32_t cell) {
  const std::int32_t now = ground_.cost_by_neighbours(levelled_, cell);
  if (now < levelled_[cell]) {
    levelled_[cell] = now;
    spread(cell);
  } else if (now > levelled_[cell] && levelled_[cell] < Field::kUnreached) {
    raise(cell);
    if (now < Field::kUnreached) queue_.push({cell, key(cell, now), true});
  }
}

/// The cell has lost what its cost rested on; what rested on it is in doubt.
void Wave::raise(std::uint32_t cell) {
  const std::int32_t was = key(cell, levelled_[cell]);
  levelled_[cell] = Field::kUnreached;
  for (int d = 0; d < 8; ++d) {
    const std::uint32_t other = cell + static_cast<std::uint32_t>(ground_.step(d));
    if (levelled_[other] >= Field::kUnreached) continue;
    const std::int32_t due = key(other, levelled_[other]);
    if (due >= was + kLeastUnits) queue_.push({other, due, true});
  }
}

void Wave::lower(std::uint32_t cell, std::int32_t levelled) {
  levelled_[cell] = levelled;
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
