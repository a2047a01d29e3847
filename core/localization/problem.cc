#include "core/localization/problem.h"

#include <algorithm>
#include <cmath>

#include "core/common/angle.h"

namespace cairn {
namespace {

/// The map's axes seen from the site.
Eigen::Vector2d turned(const Eigen::Vector2d& v, double yaw_rad) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

Eigen::Vector2d robot_in_submap(const RegistrationPrior& prior) {
  return {prior.T_submap_robot.x_m, prior.T_submap_robot.y_m};
}

/// [cells] No corner of the raster lies farther from the pivot.
int reach_from(const MatchRaster& raster, const Eigen::Vector2d& pivot) {
  const double dx = std::max(std::abs(pivot.x()), std::abs(raster.width - pivot.x()));
  const double dy = std::max(std::abs(pivot.y()), std::abs(raster.height - pivot.y()));
  return static_cast<int>(std::ceil(std::hypot(dx, dy)));
}

std::int32_t round_mm(double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); }

}  // namespace

MatchProblem make_problem(const HeightMap& short_term, const RegistrationPrior& prior,
                          const HeightMap& long_term, const SearchWindow& window,
                          const RegistrationConfig& config, int offset_mm) {
  MatchProblem problem;
  const double cell_m = long_term.cell_size_m();
  const RobotPlace robot = robot_place(prior);
  problem.prior_yaw_rad = prior.T_site_submap.yaw_rad;
  problem.yaw_step_rad = window.yaw_step_rad;
  problem.reach = static_cast<int>(std::lround(window.reach_m / cell_m));
  problem.yaw_reach = static_cast<int>(std::lround(window.yaw_rad / window.yaw_step_rad));

  const MapBox box = *known_box(short_term);
  const std::int32_t datum_mm = round_mm(robot[2]);
  const std::int32_t lifted_mm = round_mm(prior.T_site_submap.z_m) + offset_mm;
  problem.short_term =
      make_raster(short_term, box.lowest, box.highest.x - box.lowest.x + 1,
                  box.highest.y - box.lowest.y + 1, datum_mm - lifted_mm, kUnknownInShort);
  Turning& turning = problem.turning;
  turning.pivot_short =
      robot_in_submap(prior) / cell_m - Eigen::Vector2d(box.lowest.x, box.lowest.y);
  turning.reach = reach_from(problem.short_term, turning.pivot_short);

  const CellIndex pivot = long_term.cell_at(robot[0], robot[1]);
  const int margin = turning.reach + 1;
  const int side = 2 * margin + 1 + 2 * problem.reach;
  problem.long_term =
      make_raster(long_term, {pivot.x - margin - problem.reach, pivot.y - margin - problem.reach},
                  side + TurnedMap::kBlock, side, datum_mm, kUnknownInLong);
  turning.pivot_long =
      Eigen::Vector2d(robot[0] / cell_m - pivot.x + margin, robot[1] / cell_m - pivot.y + margin);
  turning.long_width = problem.long_term.width;

  const auto known = static_cast<double>(short_term.known_count());
  problem.min_overlap = static_cast<std::uint32_t>(
      std::max(config.min_overlap * known, static_cast<double>(config.min_overlap_cells)));
  return problem;
}

int median_offset_mm(const MatchProblem& problem, const Candidate& candidate) {
  const TurnedMap turned =
      turn(problem.short_term, problem.turning, problem.yaw_rad(candidate.yaw));
  const std::int16_t* there =
      problem.long_term.height_mm.data() + problem.at(candidate.x, candidate.y);
  std::vector<int> differences;
  for (std::size_t i = 0; i < turned.height_mm.size(); ++i) {
    const int difference =
        there[turned.at[i / TurnedMap::kBlock] + i % TurnedMap::kBlock] - turned.height_mm[i];
    if (std::abs(difference) <= kOverlapLimitMm) differences.push_back(difference);
  }
  if (differences.empty()) return 0;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

std::vector<ShortTermCell> short_term_cells(const MatchRaster& short_term, double cell_m,
                                            const RegistrationPrior& prior) {
  const std::vector<std::int16_t> top = highest_around(short_term);
  const double above_foot_mm = short_term.datum_mm - prior.T_submap_robot.z_m * 1000.0;
  std::vector<ShortTermCell> cells;
  for (int y = 0; y < short_term.height; ++y) {
    for (int x = 0; x < short_term.width; ++x) {
      if (!short_term.known(x, y)) continue;
      const Eigen::Vector2d middle(short_term.lowest.x + x + 0.5, short_term.lowest.y + y + 0.5);
      const Eigen::Vector2d from_robot_m = middle * cell_m - robot_in_submap(prior);
      cells.push_back({from_robot_m, short_term.at(x, y) + above_foot_mm,
                       top[short_term.index(x, y)] + above_foot_mm,
                       prior.incline_sigma_rad * from_robot_m.norm() * 1000.0});
    }
  }
  return cells;
}

RobotPlace robot_place(const RegistrationPrior& prior) {
  const Pose& submap = prior.T_site_submap;
  const Eigen::Vector2d robot = turned(robot_in_submap(prior), submap.yaw_rad);
  return {submap.x_m + robot.x(), submap.y_m + robot.y(), submap.z_m + prior.T_submap_robot.z_m,
          submap.yaw_rad};
}

Pose submap_pose(const RegistrationPrior& prior, const RobotPlace& place) {
  const Eigen::Vector2d robot = turned(robot_in_submap(prior), place[3]);
  Pose pose;
  pose.x_m = place[0] - robot.x();
  pose.y_m = place[1] - robot.y();
  pose.z_m = place[2] - prior.T_submap_robot.z_m;
  pose.yaw_rad = place[3];
  return pose;
}

Pose robot_pose(const RegistrationPrior& prior, const Pose& T_site_submap) {
  Pose level = T_site_submap;
  level.roll_rad = 0.0;
  level.pitch_rad = 0.0;
  return from_transform(to_transform(level) * to_transform(prior.T_submap_robot));
}

FaceSearch face_search(double cell_m, const RegistrationConfig& config) {
  const auto cells = [&](double m) { return static_cast<int>(std::lround(m / cell_m)); };
  return {cells(config.ground_reach_m), cells(config.far_ground_reach_m), config.ground_rise_mm,
          config.face_mm};
}

}  // namespace cairn
