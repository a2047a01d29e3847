#include "core/frontier/frontier.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/frontier/reach.h"

namespace cairn {
namespace {

class Finder {
 public:
  Finder(const DrivableGrid& grid, const Eigen::Vector2d& from_m, const FrontierConfig& config,
         const std::optional<AreaM>& area)
      : grid_(grid),
        config_(config),
        area_(area),
        cell_m_(grid.heights.cell_size_mm / 1000.0),
        reach_(reach_from(grid, from_m)) {}

  std::vector<Frontier> run() {
    std::vector<Frontier> found;
    if (reach_.way.empty()) return found;
    taken_.assign(reach_.way.size(), 0);
    seen_.assign(reach_.way.size(), 0);
    for (const CellIndex cell : edge_cells_by_way()) {
      if (taken_[grid_.heights.at(cell)] != 0) continue;
      Frontier frontier = gather(cell);
      if (frontier.new_area_m2 >= config_.min_area_m2) found.push_back(std::move(frontier));
    }
    std::ranges::stable_sort(found, [](const Frontier& a, const Frontier& b) {
      return std::tie(b.promise, a.way_m) < std::tie(a.promise, b.way_m);
    });
    return found;
  }

 private:
  [[nodiscard]] Eigen::Vector2d middle_m(CellIndex cell) const {
    return {(cell.x + 0.5) * cell_m_, (cell.y + 0.5) * cell_m_};
  }
  [[nodiscard]] bool wanted(CellIndex cell) const {
    return !area_ || area_->contains(middle_m(cell));
  }
  [[nodiscard]] bool unseen(CellIndex cell) const {
    return grid_.heights.contains(cell) &&
           grid_.classes[grid_.heights.at(cell)] == CellClass::unknown && wanted(cell);
  }
  /// Beside unseen ground, and one can stand there.
  [[nodiscard]] bool is_edge(CellIndex cell) const {
    if (!grid_.heights.contains(cell) || !wanted(cell)) return false;
    const std::size_t at = grid_.heights.at(cell);
    if (grid_.open[at] == 0 || reach_.way[at] == Reach::kNone) return false;
    for (int d = 0; d < 8; d += 2) {
      if (unseen({cell.x + kStepX[d], cell.y + kStepY[d]})) return true;
    }
    return false;
  }

  [[nodiscard]] std::vector<CellIndex> edge_cells_by_way() const {
    std::vector<std::tuple<std::uint32_t, std::int32_t, std::int32_t>> cells;
    const HeightGrid& heights = grid_.heights;
    for (std::int32_t y = heights.origin.y; y < heights.origin.y + heights.height; ++y) {
      for (std::int32_t x = heights.origin.x; x < heights.origin.x + heights.width; ++x) {
        if (is_edge({x, y})) cells.emplace_back(reach_.way[heights.at({x, y})], y, x);
      }
    }
    std::ranges::sort(cells);
    std::vector<CellIndex> sorted;
    sorted.reserve(cells.size());
    for (const auto& [way, y, x] : cells) sorted.push_back({x, y});
    return sorted;
  }

  /// The edge cells that hang together with the cheapest one, as far as reach_m, and the unseen
  /// ground behind them.
  Frontier gather(CellIndex first) {
    Frontier frontier;
    frontier.place_m = middle_m(first);
    frontier.way_m = reach_.way[grid_.heights.at(first)] / Reach::kPerCell * cell_m_;
    std::vector<CellIndex> edge{first};
    taken_[grid_.heights.at(first)] = 1;
    for (std::size_t i = 0; i < edge.size(); ++i) {
      for (int d = 0; d < 8; ++d) {
        const CellIndex near{edge[i].x + kStepX[d], edge[i].y + kStepY[d]};
        if (!is_edge(near) || taken_[grid_.heights.at(near)] != 0) continue;
        if ((middle_m(near) - frontier.place_m).norm() > config_.reach_m) continue;
        taken_[grid_.heights.at(near)] = 1;
        edge.push_back(near);
      }
    }
    frontier.new_area_m2 = area_behind(edge, frontier.place_m);
    frontier.promise = frontier.new_area_m2 / (config_.head_start_m + frontier.way_m);
    frontier.edge = std::move(edge);
    return frontier;
  }

  double area_behind(const std::vector<CellIndex>& edge, const Eigen::Vector2d& place_m) {
    std::vector<CellIndex> ground;
    const auto spread = [&](CellIndex cell) {
      for (int d = 0; d < 8; d += 2) {
        const CellIndex near{cell.x + kStepX[d], cell.y + kStepY[d]};
        if (!unseen(near) || seen_[grid_.heights.at(near)] != 0) continue;
        if ((middle_m(near) - place_m).norm() > config_.view_m) continue;
        seen_[grid_.heights.at(near)] = 1;
        ground.push_back(near);
      }
    };
    for (const CellIndex cell : edge) spread(cell);
    for (std::size_t i = 0; i < ground.size(); ++i) spread(ground[i]);
    for (const CellIndex cell : ground) seen_[grid_.heights.at(cell)] = 0;
    return static_cast<double>(ground.size()) * cell_m_ * cell_m_;
  }

  const DrivableGrid& grid_;
  FrontierConfig config_;
  std::optional<AreaM> area_;
  double cell_m_;
  Reach reach_;
  std::vector<std::uint8_t> taken_;  ///< Edge cells that belong to a frontier.
  std::vector<std::uint8_t> seen_;   ///< Used by area_behind, all 0 between its calls.
};

}  // namespace

std::vector<Frontier> find_frontiers(const DrivableGrid& grid, const Eigen::Vector2d& from_m,
                                     const FrontierConfig& config,
                                     const std::optional<AreaM>& area) {
  return Finder(grid, from_m, config, area).run();
}

}  // namespace cairn
