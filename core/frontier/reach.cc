#include "core/frontier/reach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace cairn {
namespace {

/// Buckets of Dial's wave: one more than the longest step.
constexpr std::uint32_t kBuckets = 8;

class Wave {
 public:
  Wave(const DrivableGrid& grid, CellIndex start) : grid_(grid), start_(start) {
    const double cell_m = grid.heights.cell_size_mm / 1000.0;
    leave_cells_ = static_cast<int>(std::min(2.0 * grid.limits.radius_m / cell_m + 2.0, 256.0));
    reach_.way.assign(grid.open.size(), Reach::kNone);
  }

  Reach run() {
    enter(start_, 0);
    for (std::uint32_t now = 0; waiting_ > 0; ++now) {
      // Cells that this bucket gains meanwhile belong to a later turn of it.
      const std::vector<CellIndex> cells = std::exchange(buckets_[now % kBuckets], {});
      waiting_ -= cells.size();
      for (const CellIndex cell : cells) {
        if (reach_.way[grid_.heights.at(cell)] == now) spread(cell, now);
      }
    }
    return std::move(reach_);
  }

 private:
  void enter(CellIndex cell, std::uint32_t way) {
    std::uint32_t& known = reach_.way[grid_.heights.at(cell)];
    if (way >= known) return;
    known = way;
    buckets_[way % kBuckets].push_back(cell);
    ++waiting_;
  }

  void spread(CellIndex from, std::uint32_t way) {
    for (int direction = 0; direction < 8; ++direction) {
      const int dx = kStepX[direction];
      const int dy = kStepY[direction];
      const CellIndex to{from.x + dx, from.y + dy};
      if (!passable(to) || !within_limits(from, to)) continue;
      const bool diagonal = dx != 0 && dy != 0;
      if (diagonal && !(passable({from.x + dx, from.y}) && passable({from.x, from.y + dy}))) {
        continue;
      }
      enter(to, way + (diagonal ? 7 : 5));
    }
  }

  [[nodiscard]] bool passable(CellIndex cell) const {
    if (!grid_.heights.contains(cell)) return false;
    const std::size_t at = grid_.heights.at(cell);
    if (grid_.open[at] != 0) return true;
    const bool near_start =
        std::max(std::abs(cell.x - start_.x), std::abs(cell.y - start_.y)) <= leave_cells_;
    return near_start && start_is_closed() && grid_.classes[at] != CellClass::obstacle;
  }
  [[nodiscard]] bool start_is_closed() const { return grid_.open[grid_.heights.at(start_)] == 0; }

  [[nodiscard]] bool within_limits(CellIndex from, CellIndex to) const {
    const std::size_t a = grid_.heights.at(from);
    const std::size_t b = grid_.heights.at(to);
    if (grid_.heights.probability[a] == 0 || grid_.heights.probability[b] == 0) return true;
    const std::int64_t rise_mm =
        std::int64_t{grid_.heights.height_mm[b]} - grid_.heights.height_mm[a];
    return rise_mm <= grid_.limits.climb_mm && -rise_mm <= grid_.limits.descend_mm;
  }

  const DrivableGrid& grid_;
  CellIndex start_;
  int leave_cells_ = 0;
  Reach reach_;
  std::array<std::vector<CellIndex>, kBuckets> buckets_;
  std::size_t waiting_ = 0;
};

}  // namespace

Reach reach_from(const DrivableGrid& grid, const Eigen::Vector2d& place_m) {
  if (!(place_m.cwiseAbs().maxCoeff() < HeightMap::kMaxExtentM)) return {};
  const double cell_m = grid.heights.cell_size_mm / 1000.0;
  const CellIndex start{static_cast<std::int32_t>(std::floor(place_m.x() / cell_m)),
                        static_cast<std::int32_t>(std::floor(place_m.y() / cell_m))};
  if (!grid.heights.contains(start)) return {};
  return Wave(grid, start).run();
}

}  // namespace cairn
