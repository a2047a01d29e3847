#include "server/mission/planning.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace cairn::server {

namespace {

/// [m] Room kept around everything, so that ways around obstacles at the edge stay possible.
constexpr double kMarginM = 3.0;

/// Tiles from the lowest to the highest.
struct TileWindow {
  std::int64_t lowest_x = std::numeric_limits<std::int64_t>::max();
  std::int64_t lowest_y = std::numeric_limits<std::int64_t>::max();
  std::int64_t highest_x = std::numeric_limits<std::int64_t>::min();
  std::int64_t highest_y = std::numeric_limits<std::int64_t>::min();

  void include(std::int64_t tx, std::int64_t ty) {
    lowest_x = std::min(lowest_x, tx);
    lowest_y = std::min(lowest_y, ty);
    highest_x = std::max(highest_x, tx);
    highest_y = std::max(highest_y, ty);
  }
};

}  // namespace

Result<MapWindow> window_around(const MapSnapshot& map,
                                const std::vector<Eigen::Vector2d>& points_m) {
  TileWindow window;
  const double tile_m = map.cell_size_mm / 1000.0 * Tile::kSize;
  const auto tile_at = [&](double m) { return static_cast<std::int64_t>(std::floor(m / tile_m)); };
  for (const auto& [key, tile] : map.tiles) window.include(key.tx, key.ty);
  for (const Eigen::Vector2d& point : points_m) {
    window.include(tile_at(point.x() - kMarginM), tile_at(point.y() - kMarginM));
    window.include(tile_at(point.x() + kMarginM), tile_at(point.y() + kMarginM));
  }
  if (window.highest_x < window.lowest_x) {
    return Error{ErrorCode::unavailable, "the map is empty: let a robot look around first"};
  }
  const auto cell = [](std::int64_t tile) { return static_cast<std::int32_t>(tile * Tile::kSize); };
  return MapWindow{
      {cell(window.lowest_x), cell(window.lowest_y)},
      {cell(window.highest_x + 1) - 1, cell(window.highest_y + 1) - 1},
  };
}

Result<HeightGrid> heights_in(const MapSnapshot& map, const MapWindow& window,
                              std::uint8_t min_probability) {
  auto grid = empty_grid(window.lowest, window.highest, map.cell_size_mm);
  if (!grid) return grid.error();
  for (const auto& [key, tile] : map.tiles) {
    if (key.level == 0) draw_tile(*grid, key, tile->unpack(), min_probability);
  }
  return grid;
}

Result<DrivableGrid> drivable_grid(const MapSnapshot& map,
                                   const std::vector<Eigen::Vector2d>& points_m,
                                   const PlannerConfig& config, std::uint8_t min_probability) {
  const auto window = window_around(map, points_m);
  if (!window) return window.error();
  auto heights = heights_in(map, *window, min_probability);
  if (!heights) return heights.error();
  return make_drivable(std::move(*heights), config);
}

std::vector<Eigen::Vector2d> rest_of(const std::vector<Eigen::Vector2d>& path_m,
                                     const Eigen::Vector2d& place_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  std::size_t leg = 0;
  Eigen::Vector2d foot = place_m;
  for (std::size_t i = 0; i + 1 < path_m.size(); ++i) {
    const Eigen::Vector2d along = path_m[i + 1] - path_m[i];
    const double length2 = along.squaredNorm();
    const double t =
        length2 > 0.0 ? std::clamp((place_m - path_m[i]).dot(along) / length2, 0.0, 1.0) : 0.0;
    const Eigen::Vector2d candidate = path_m[i] + t * along;
    if (const double distance_m = (candidate - place_m).norm(); distance_m < nearest_m) {
      nearest_m = distance_m;
      leg = i;
      foot = candidate;
    }
  }
  std::vector<Eigen::Vector2d> rest{foot};
  for (std::size_t i = leg + 1; i < path_m.size(); ++i) rest.push_back(path_m[i]);
  return rest;
}

namespace {

CellIndex cell_of(const DrivableGrid& grid, const Eigen::Vector2d& p_m) {
  const double cells_per_m = 1000.0 / grid.heights.cell_size_mm;
  return {static_cast<std::int32_t>(std::floor(p_m.x() * cells_per_m)),
          static_cast<std::int32_t>(std::floor(p_m.y() * cells_per_m))};
}

/// The first open place on the way from `from_m` to `to_m`, as near as a plan's way out may be and
/// before any obstacle.
std::optional<Eigen::Vector2d> way_out(const DrivableGrid& grid, const Eigen::Vector2d& from_m,
                                       const Eigen::Vector2d& to_m) {
  const double cell_m = grid.heights.cell_size_mm / 1000.0;
  const Eigen::Vector2d way = to_m - from_m;
  const double reach_m = std::min(way.norm(), 2.0 * (grid.limits.radius_m + cell_m));
  const Eigen::Vector2d ahead = way.norm() > 0.0 ? way.normalized() : Eigen::Vector2d::Zero();
  const CellIndex start = cell_of(grid, from_m);
  for (double way_m = 0.0; way_m <= reach_m; way_m += 0.5 * cell_m) {
    const Eigen::Vector2d p_m = from_m + way_m * ahead;
    const CellIndex cell = cell_of(grid, p_m);
    if (!grid.heights.contains(cell)) return std::nullopt;
    const std::size_t at = grid.heights.at(cell);
    if (grid.open[at] != 0) return p_m;
    if (cell != start && grid.classes[at] == CellClass::obstacle) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

bool path_is_open(const DrivableGrid& grid, const std::vector<Eigen::Vector2d>& path_m) {
  for (std::size_t i = 0; i + 1 < path_m.size(); ++i) {
    const auto from_m = i == 0 ? way_out(grid, path_m[0], path_m[1]) : std::optional(path_m[i]);
    if (!from_m || !line_is_open(grid, *from_m, path_m[i + 1])) return false;
  }
  return true;
}

}  // namespace cairn::server
