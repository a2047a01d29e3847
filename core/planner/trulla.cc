#include "core/planner/trulla.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/planner/step_prices.h"

namespace cairn {
namespace {

/// Cells waiting for the wave, in a ring of buckets by cost (Dial 1969). A bucket is as wide as the
/// cheapest step, so nothing that is still to come can better a cell of the lowest bucket (Denardo
/// & Fox 1979) and its order does not matter. What is too dear for the ring waits in the farthest
/// bucket and is put back from there.
class WaveQueue {
 public:
  struct Entry {
    std::uint32_t cell;
    std::uint32_t cost;
  };

  /// Requires: bucket_width > 0.
  explicit WaveQueue(std::uint32_t bucket_width) : width_(bucket_width) {}

  /// Requires: the cost is not below that of the last entry taken.
  void push(Entry entry) {
    const std::uint32_t ahead = entry.cost / width_ - lowest_;
    ring_[(lowest_ + std::min(ahead, kBuckets - 1)) % kBuckets].push_back(entry);
    ++waiting_;
  }

  /// An entry of the lowest bucket. False when nothing waits.
  bool pop(Entry& entry) {
    while (waiting_ > 0) {
      auto& bucket = ring_[lowest_ % kBuckets];
      if (bucket.empty()) {
        ++lowest_;
        continue;
      }
      entry = bucket.back();
      bucket.pop_back();
      --waiting_;
      if (entry.cost / width_ == lowest_) return true;
      push(entry);
    }
    return false;
  }

 private:
  static constexpr std::uint32_t kBuckets = 256;

  std::array<std::vector<Entry>, kBuckets> ring_;
  std::uint32_t width_;
  std::uint32_t lowest_ = 0;
  std::size_t waiting_ = 0;
};

/// One run of Trulla over one grid.
class Wave {
 public:
  Wave(const DrivableGrid& grid, const PlannerConfig& config, Field& field)
      : grid_(grid),
        prices_(config, grid.heights.cell_size_mm),
        field_(field),
        queue_(prices_.cheapest()) {}

  void radiate_from(std::uint32_t goal) {
    field_.cost[goal] = 0;
    field_.direction[goal] = Field::kAtGoal;
    queue_.push({goal, 0});
    for (WaveQueue::Entry entry{}; queue_.pop(entry);) {
      if (entry.cost == field_.cost[entry.cell]) spread(entry);
    }
  }

 private:
  /// Offers the way through this cell to each neighbour from which one may step into it.
  void spread(WaveQueue::Entry via) {
    const auto width = static_cast<std::uint32_t>(field_.width);
    const std::uint32_t x = via.cell % width;
    const std::uint32_t y = via.cell / width;
    const bool east = x + 1 < width && grid_.open[via.cell + 1];
    const bool north =
        y + 1 < static_cast<std::uint32_t>(field_.height) && grid_.open[via.cell + width];
    const bool west = x > 0 && grid_.open[via.cell - 1];
    const bool south = y > 0 && grid_.open[via.cell - width];
    // The direction is the neighbour's step, so it points back. A diagonal needs both its sides.
    if (east) offer(via, via.cell + 1, 4);
    if (west) offer(via, via.cell - 1, 0);
    if (north) offer(via, via.cell + width, 6);
    if (south) offer(via, via.cell - width, 2);
    if (north && east) offer(via, via.cell + width + 1, 5);
    if (north && west) offer(via, via.cell + width - 1, 7);
    if (south && east) offer(via, via.cell - width + 1, 3);
    if (south && west) offer(via, via.cell - width - 1, 1);
  }

  void offer(WaveQueue::Entry via, std::uint32_t from, std::uint8_t direction) {
    std::uint32_t& known = field_.cost[from];
    if (known <= via.cost || !grid_.open[from]) return;
    const std::uint32_t step = prices_.between(grid_.heights, from, via.cell, (direction & 1) != 0);
    if (step >= kNoWay - via.cost) return;  // Also when the sum would not fit.
    const std::uint32_t cost = via.cost + step;
    if (cost < known) {
      known = cost;
      field_.direction[from] = direction;
      queue_.push({from, cost});
    } else if (cost == known && direction < field_.direction[from]) {
      field_.direction[from] = direction;
    }
  }

  const DrivableGrid& grid_;
  const StepPrices prices_;
  Field& field_;
  WaveQueue queue_;
};

}  // namespace

Result<Field> compute_field(const DrivableGrid& grid, CellIndex goal, const PlannerConfig& config) {
  if (const std::string why = why_closed(grid, goal); !why.empty()) {
    return Error{ErrorCode::invalid_argument, "the goal " + why};
  }
  const std::size_t cells = grid.open.size();
  Field field{grid.heights.origin,
              grid.heights.width,
              grid.heights.height,
              goal,
              std::vector<std::uint32_t>(cells, kNoWay),
              std::vector<std::uint8_t>(cells, Field::kNoDirection)};
  Wave(grid, config, field).radiate_from(static_cast<std::uint32_t>(grid.heights.at(goal)));
  return field;
}

}  // namespace cairn
