#include "tests/bench/shortest_ways.h"

#include <cmath>
#include <functional>
#include <queue>
#include <vector>

namespace cairn::bench {
namespace {

/// A place in half cells: middles are odd, corners even.
struct Place {
  int x;
  int y;
};

class Sight {
 public:
  explicit Sight(const DrivableGrid& grid) : grid_(grid) {}

  [[nodiscard]] bool open(int x, int y) const {
    const CellIndex cell{grid_.heights.origin.x + x, grid_.heights.origin.y + y};
    return grid_.heights.contains(cell) && grid_.open[grid_.heights.at(cell)] != 0;
  }

  /// Whether no closed cell's inside lies on the line, and the line does not run between two
  /// closed cells.
  [[nodiscard]] bool clear(Place a, Place b) const {
    if (a.x > b.x) std::swap(a, b);
    const std::int64_t dx = b.x - a.x;
    const std::int64_t dy = b.y - a.y;
    if (dx == 0) return clear_upright(a, b);
    for (int column = a.x >> 1; 2 * column < b.x; ++column) {
      // y, times dx, where the line enters and leaves the column.
      const std::int64_t in = std::max<std::int64_t>(2 * column, a.x) - a.x;
      const std::int64_t out = std::min<std::int64_t>(2 * column + 2, b.x) - a.x;
      const std::int64_t y0 = a.y * dx + std::min(in * dy, out * dy);
      const std::int64_t y1 = a.y * dx + std::max(in * dy, out * dy);
      if (dy == 0) {
        const bool border = (a.y & 1) == 0;
        if (!open(column, a.y >> 1) && !(border && open(column, (a.y >> 1) - 1))) return false;
        continue;
      }
      for (std::int64_t row = floor_div(y0, 2 * dx); row * 2 * dx < y1; ++row) {
        if (!open(column, static_cast<int>(row))) return false;
      }
    }
    return true;
  }

 private:
  static std::int64_t floor_div(std::int64_t a, std::int64_t b) {
    return a >= 0 ? a / b : -((-a + b - 1) / b);
  }

  [[nodiscard]] bool clear_upright(Place a, Place b) const {
    const bool border = (a.x & 1) == 0;
    for (int row = std::min(a.y, b.y) >> 1; 2 * row < std::max(a.y, b.y); ++row) {
      if (!open(a.x >> 1, row) && !(border && open((a.x >> 1) - 1, row))) return false;
    }
    return true;
  }

  const DrivableGrid& grid_;
};

/// Corners that a shortest way can turn at: exactly one of the four cells is closed, or two that
/// touch only there.
std::vector<Place> turning_corners(const DrivableGrid& grid, const Sight& sight) {
  std::vector<Place> corners;
  for (int y = 1; y < grid.heights.height; ++y) {
    for (int x = 1; x < grid.heights.width; ++x) {
      const int closed = !sight.open(x, y) + !sight.open(x - 1, y) + !sight.open(x, y - 1) +
                         !sight.open(x - 1, y - 1);
      // Between two that touch there is no way through.
      if (closed == 1) corners.push_back({2 * x, 2 * y});
    }
  }
  return corners;
}

double distance(Place a, Place b) { return std::hypot(a.x - b.x, a.y - b.y) / 2; }

}  // namespace

std::optional<double> shortest_way(const DrivableGrid& grid, CellIndex start, CellIndex goal) {
  const Sight sight(grid);
  const auto middle = [&](CellIndex c) {
    return Place{2 * (c.x - grid.heights.origin.x) + 1, 2 * (c.y - grid.heights.origin.y) + 1};
  };
  std::vector<Place> places = turning_corners(grid, sight);
  places.push_back(middle(goal));
  places.push_back(middle(start));
  const std::size_t end = places.size() - 2;
  std::vector<double> so_far(places.size(), HUGE_VAL);
  std::vector<bool> done(places.size());
  using Item = std::pair<double, std::size_t>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  so_far.back() = 0.0;
  queue.emplace(0.0, places.size() - 1);
  while (!queue.empty()) {
    const std::size_t at = queue.top().second;
    queue.pop();
    if (at == end) return so_far[end];
    if (done[at]) continue;
    done[at] = true;
    for (std::size_t next = 0; next <= end; ++next) {
      const double length = so_far[at] + distance(places[at], places[next]);
      if (done[next] || length >= so_far[next] || !sight.clear(places[at], places[next])) continue;
      so_far[next] = length;
      queue.emplace(length + distance(places[next], places[end]), next);
    }
  }
  return {};
}

}  // namespace cairn::bench
