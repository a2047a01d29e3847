#include "core/localization/site_points.h"

#include <algorithm>
#include <cmath>

#include "core/localization/match_raster.h"
#include "core/localization/raster_surroundings.h"

namespace cairn {
namespace {

/// [mm] What stands higher above the ground beside it than this is no ground.
constexpr int kFaceMm = 175;

/// At most `count` of them, evenly along the row.
std::vector<ShownCell> thinned(const std::vector<ShownCell>& cells, int count) {
  const auto keep = static_cast<std::size_t>(std::max(count, 0));
  if (cells.size() <= keep) return cells;
  std::vector<ShownCell> few;
  few.reserve(keep);
  for (std::size_t i = 0; i < keep; ++i) few.push_back(cells[i * cells.size() / keep]);
  return few;
}

}  // namespace

std::vector<ShownCell> shown_cells(const HeightMap& short_term, const Pose& T_submap_robot,
                                   double reach_m, int faces, int flats) {
  const double cell_m = short_term.cell_size_m();
  const Eigen::Vector2d robot = Eigen::Vector2d(T_submap_robot.x_m, T_submap_robot.y_m) / cell_m;
  const int reach = static_cast<int>(std::ceil(reach_m / cell_m));
  const CellIndex lowest{static_cast<std::int32_t>(std::floor(robot.x())) - reach,
                         static_cast<std::int32_t>(std::floor(robot.y())) - reach};
  const int side = 2 * reach + 1;
  const auto foot_mm = static_cast<std::int32_t>(std::lround(T_submap_robot.z_m * 1000.0));
  const MatchRaster raster = make_raster(short_term, lowest, side, side, foot_mm, kUnknownInShort);
  // Beside what is seen of a wall far away there is no ground; the robot's own stands in for it.
  const auto near = static_cast<int>(std::lround(0.75 / cell_m));
  const std::vector<std::int16_t> ground = ground_under(raster, {near, 2 * near, 2 * kFaceMm});
  std::vector<ShownCell> standing, flat;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      if (!raster.known(x, y)) continue;
      const Eigen::Vector2d from_robot(lowest.x + x + 0.5 - robot.x(),
                                       lowest.y + y + 0.5 - robot.y());
      const double away_m = from_robot.norm() * cell_m;
      if (away_m > reach_m) continue;
      const int height = raster.at(x, y);
      const bool face = height - ground[raster.index(x, y)] > kFaceMm ||
                        height > kFaceMm + static_cast<int>(30.0 * away_m);
      (face ? standing : flat).push_back({from_robot, static_cast<double>(height), face});
    }
  }
  std::vector<ShownCell> cells = thinned(standing, faces);
  for (const ShownCell& cell : thinned(flat, flats)) cells.push_back(cell);
  return cells;
}

std::vector<SitePoint> turned_points(const std::vector<ShownCell>& cells, double yaw_rad,
                                     int unit_mm, double cell_m, double far_sigma) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  std::vector<SitePoint> points;
  points.reserve(cells.size());
  for (const ShownCell& cell : cells) {
    const double x = c * cell.from_robot.x() - s * cell.from_robot.y();
    const double y = s * cell.from_robot.x() + c * cell.from_robot.y();
    const double doubt_mm = far_sigma * cell.from_robot.norm() * cell_m * 1000.0;
    points.push_back({static_cast<std::int16_t>(std::lround(x)),
                      static_cast<std::int16_t>(std::lround(y)),
                      static_cast<std::int16_t>(std::floor((cell.height_mm - doubt_mm) / unit_mm)),
                      static_cast<std::int16_t>(std::ceil((cell.height_mm + doubt_mm) / unit_mm))});
  }
  return points;
}

}  // namespace cairn
