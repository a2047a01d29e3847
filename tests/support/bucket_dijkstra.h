#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace cairn::test {

/// What planners ship: Dijkstra's search over the eight neighbours with buckets (Dial 1969) in
/// floating point, from prices per cell, its corner rule kept. The peer that fields are timed
/// against.
class BucketDijkstra {
 public:
  /// `price`: row by row, 0 = closed, else [cells] the cost to cross it, 1 … 3.9. The outermost
  /// cells must be closed.
  BucketDijkstra(std::vector<float> price, int width) : price_(std::move(price)), width_(width) {}

  /// [cells] Cost to `goal` from every cell; kFar where there is no way.
  const std::vector<float>& radiate(std::uint32_t goal) {
    cost_.assign(price_.size(), kFar);
    cost_[goal] = 0.0F;
    ring_[0].push_back(goal);
    std::size_t waiting = 1;
    for (std::uint32_t level = 0; waiting > 0; ++level) {
      std::vector<std::uint32_t>& bucket = ring_[level % kBuckets];
      for (std::size_t i = 0; i < bucket.size(); ++i) {
        const std::uint32_t cell = bucket[i];
        --waiting;
        if (static_cast<std::uint32_t>(cost_[cell]) == level) waiting += spread(cell);
      }
      bucket.clear();
    }
    return cost_;
  }

  static constexpr float kFar = 1e30F;

 private:
  static constexpr std::uint32_t kBuckets = 16;

  std::size_t spread(std::uint32_t cell) {
    const auto w = static_cast<std::uint32_t>(width_);
    const bool east = price_[cell + 1] > 0;
    const bool west = price_[cell - 1] > 0;
    const bool north = price_[cell + w] > 0;
    const bool south = price_[cell - w] > 0;
    std::size_t pushed = 0;
    const auto offer = [&](bool free_way, std::uint32_t to, float half_length) {
      if (!free_way || !(price_[to] > 0)) return;
      const float cost = cost_[cell] + (price_[cell] + price_[to]) * half_length;
      if (!(cost < cost_[to])) return;
      cost_[to] = cost;
      ring_[static_cast<std::uint32_t>(cost) % kBuckets].push_back(to);
      ++pushed;
    };
    constexpr float kHalf = 0.5F;
    constexpr float kHalfDiagonal = 0.70710678F;
    offer(east, cell + 1, kHalf);
    offer(west, cell - 1, kHalf);
    offer(north, cell + w, kHalf);
    offer(south, cell - w, kHalf);
    offer(north && east, cell + w + 1, kHalfDiagonal);
    offer(north && west, cell + w - 1, kHalfDiagonal);
    offer(south && east, cell - w + 1, kHalfDiagonal);
    offer(south && west, cell - w - 1, kHalfDiagonal);
    return pushed;
  }

  std::vector<float> price_;
  int width_;
  std::vector<float> cost_;
  std::array<std::vector<std::uint32_t>, kBuckets> ring_;
};

}  // namespace cairn::test
