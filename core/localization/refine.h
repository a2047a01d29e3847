#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/localization/long_term_relief.h"

namespace cairn {

/// A known cell of a short-term map, as seen from the robot.
struct ShortTermCell {
  Eigen::Vector2d from_robot_m;  ///< Its middle, along the short-term map's axes.
  double height_mm = 0.0;        ///< Above the robot's foot.
  double top_mm = 0.0;           ///< The highest near it, see highest_around.
  double incline_mm = 0.0;       ///< Spread of its height by the error of the robot's incline.
};

struct RefineConfig {
  /// [mm] Spread of a flat cell's height between two maps.
  double flat_sigma_mm = 20.0;
  /// [-] What of the heights around a cell adds to its spread: cells cover edges differently.
  double relief_share = 0.3;
  /// [-] Of faces seen from the side the map tells which cells they cross, not where in them.
  double side_face_relief_share = 0.9;
  /// [mm] Relief from which neighbouring cells are an edge and not noise.
  double edge_relief_mm = 100.0;
  /// [-] Slopes below this may be noise and tell nothing of x, y and yaw.
  double noise_slope = 0.05;
  /// [-] Neighbouring cells err together: this many count as one.
  double cells_per_opinion = 5.0;
  /// [m] What the match alone shows worse than this, it does not show: the prior stays.
  double blind_sigma_m = 0.15;
  /// [-] So many maps hold each scan, and each of them is registered: against the prior a match
  /// counts as this part of one.
  double registered_times = 1.0;
  int max_iterations = 30;
};

/// [-] No single cell's squared difference counts more (Geman-McClure).
inline constexpr double kMostMisfit = 6.0;

/// Where the robot is believed to be: x, y, z [m] and the short-term map's yaw [rad].
using RobotPlace = Eigen::Vector4d;

struct Refinement {
  RobotPlace place;
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();  ///< Of the match alone.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();   ///< Of the place, prior included.
  std::size_t overlap = 0;                                ///< Cells known in both.
  double inliers = 0.0;      ///< [0 … 1] Share of the overlap that agrees within 3 σ.
  double residual_mm = 0.0;  ///< Weighted root mean square of the height differences.
  /// [-] Mean over the overlap of (difference / σ)², each truncated softly at kMostMisfit: near 1
  /// where the maps show the same ground.
  double misfit = 0.0;
  /// [-] Independent opinions in the overlap.
  double opinions = 0.0;
  /// [-] How much the two halves of the short-term map contradict each other: squared Mahalanobis
  /// distance between the places that each of them asks for alone, of the worst of four ways to cut
  /// it. Large where a part of the map is displaced against the rest.
  double discord = 0.0;
};

/// Gauss-Newton over x, y, z and yaw from `start`: height differences between the short-term cells
/// and the long-term surface, bilinear in between, each weighed by the relief around it (near an
/// edge a height says little, its position much) and down when it does not fit. The prior takes
/// part with its information: where the ground tells nothing, the prior stays.
/// Empty when the maps do not overlap.
[[nodiscard]] std::optional<Refinement> refine(const std::vector<ShortTermCell>& cells,
                                               const LongTermRelief& long_term,
                                               const RobotPlace& prior,
                                               const Eigen::Matrix4d& prior_information,
                                               const RobotPlace& start, const RefineConfig& config);

}  // namespace cairn
