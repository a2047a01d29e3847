#pragma once

#include <array>
#include <vector>

#include "core/planner/ground.h"

namespace cairn {

/// Cells waiting for a wave, in a ring of buckets by cost (Dial 1969). A bucket is narrower than
/// the cheapest way from one cell to another, so nothing that is still to come can better a cell of
/// the lowest bucket (Denardo & Fox 1979) and its order does not matter. What is too dear for the
/// ring waits in the farthest bucket and is put back from there.
class WaveQueue {
 public:
  struct Entry {
    std::uint32_t cell;
    std::int32_t cost;
    bool doubted;  ///< The cell's own cost is in question.
  };

  void push(Entry entry) {
    const std::int32_t bucket = entry.cost >> kBucketBits;
    const std::int32_t ahead = std::clamp(bucket - lowest_, 0, kBuckets - 1);
    ring_[static_cast<std::size_t>((lowest_ + ahead) % kBuckets)].push_back(entry);
    ++waiting_;
  }

  /// An entry of the lowest bucket. False when nothing waits.
  bool pop(Entry& entry) {
    while (waiting_ > 0) {
      auto& bucket = ring_[static_cast<std::size_t>(lowest_ % kBuckets)];
      if (bucket.empty()) {
        ++lowest_;
        continue;
      }
      entry = bucket.back();
      bucket.pop_back();
      --waiting_;
      if (entry.cost >> kBucketBits <= lowest_) return true;
      push(entry);
    }
    return false;
  }
  /// Begins anew, from this cost on. Requires: nothing waits, cost ≥ 0.
  void restart(std::int32_t cost) { lowest_ = cost >> kBucketBits; }

 private:
  static constexpr std::int32_t kBuckets = 256;
  static constexpr int kBucketBits = 9;
  static_assert((1 << kBucketBits) < kLeastUnits);

  std::array<std::vector<Entry>, kBuckets> ring_;
  std::int32_t lowest_ = 0;
  std::size_t waiting_ = 0;
};

/// Brings a field to where every cell costs what its neighbours say, cell by cell in the order of
/// costs. After a change it touches only what depends on it: a cell that has lost what it rested on
/// is first unreached and then offered what is left (as in Koenig, Likhachev & Furcy 2004).
class Wave {
 public:
  /// Both must outlive the wave.
  Wave(const DrivableGrid& grid, Field& field);

  /// Sets the goal's cost and radiates from it. Requires: an unreached field.
  void radiate();
  /// Doubts the cells, whose ground has changed, and their neighbours. Requires: the field was
  /// right before; the cells themselves are closed or unreached by now, the goal is not among them.
  /// `doubted` is work space, as long as the field: all 0, before and after. False, and the field
  /// is of no use, when more than `most` cells were looked at: then a new one is cheaper.
  [[nodiscard]] bool repair(const std::vector<std::uint32_t>& cells,
                            std::vector<std::uint8_t>& doubted, std::size_t most);

 private:
  [[nodiscard]] bool run(std::size_t most);
  void settle_doubt(std::uint32_t cell);
  void doubt(std::uint32_t cell, std::int32_t cost);
  [[nodiscard]] std::int32_t due(std::uint32_t cell) const;
  void raise(std::uint32_t cell);
  void lower(std::uint32_t cell, std::int32_t levelled);
  void spread(std::uint32_t cell);

  /// [cost units] Of a levelled cost, what the queue is ordered by: every way out of a cell is
  /// dearer than where it leads, whatever was levelled.
  [[nodiscard]] std::int32_t key(std::uint32_t cell, std::int32_t levelled) const {
    return tilted_ ? levelled - grid_.ground.one_way_effort(cell) + goal_effort_ : levelled;
  }
  [[nodiscard]] bool is_goal(std::uint32_t cell) const { return cell == goal_; }

  const DrivableGrid& grid_;
  const GroundReader ground_;
  Field& field_;
  std::int32_t* const levelled_;
  const std::uint32_t goal_;
  const bool tilted_;
  const std::int32_t goal_effort_;
  WaveQueue queue_;
  std::uint8_t* doubted_ = nullptr;  ///< Cells that wait with a doubt in their own cost.
};

/// Brings an unreached field to where every cell costs what its neighbours say: tile by tile, or
/// cell by cell on ground where many cells have rules of their own, whichever is quicker there.
/// Requires: the goal is open.
void radiate(const DrivableGrid& grid, Field& field);

}  // namespace cairn
