#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/graph/level_pose.h"
#include "core/localization/registration.h"

namespace cairn {

/// How two submaps are compared and when the match counts.
struct LoopMatchConfig {
  RegistrationConfig registration;
  double sigmas = 3.0;        ///< [σ] So far around the believed place is searched,
  double max_reach_m = 6.0;   ///< [m] but no further than this,
  double max_yaw_rad = 0.6;   ///< [rad] nor this.
  double narrow_m = 1.25;     ///< [m] Up to here every place is tried, beyond it the bold search,
  double narrow_rad = 0.2;    ///< [rad] which wants a match beyond doubt.
  double min_overlap = 0.25;  ///< [-] Of the smaller-known submap; loops meet with their edges.
  double min_inliers = 0.8;   ///< [-]
  /// [m], [rad] Submaps are not stiff: they drifted while they were made.
  double stiffness_m = 0.03;
  double stiffness_rad = 0.004;
};

/// One comparison and its evidence.
struct LoopMatch {
  LevelPose T_from_to;
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();  ///< As in GraphConstraint.
  Registration registration;
  bool accepted = false;
};

/// Lays `to` over `from` (each in its own frame), believed at T_from_to with this covariance (of
/// to's origin, along from's axes). `middle_m`: of to's known part, in its frame.
[[nodiscard]] LoopMatch match_loop(const HeightMap& to, const Eigen::Vector3d& middle_m,
                                   const HeightMap& from, const LevelPose& T_from_to,
                                   const Eigen::Matrix4d& covariance,
                                   const LoopMatchConfig& config);

/// [m], [rad] How far off the believed place of `to`'s middle may be, one sigma, the worst way.
struct PlaceSigma {
  double m = 0.0;
  double rad = 0.0;
};
[[nodiscard]] Eigen::Matrix4d covariance_at(const Eigen::Vector3d& middle_m,
                                            const LevelPose& T_from_to,
                                            const Eigen::Matrix4d& covariance);
[[nodiscard]] PlaceSigma sigma_of(const Eigen::Matrix4d& covariance_at_middle);

}  // namespace cairn
