#pragma once

#include <Eigen/Core>
#include <string>

#include "core/graph/faces.h"
#include "core/graph/footprint.h"
#include "core/graph/level_pose.h"
#include "core/localization/registration.h"

namespace cairn {

/// How two submaps are compared and when the match counts.
struct LoopMatchConfig {
  RegistrationConfig registration;
  double sigmas = 3.0;         ///< [σ] So far around the believed place is searched,
  double max_reach_m = 8.0;    ///< [m] but no further than this,
  double max_yaw_rad = 0.8;    ///< [rad] nor this: every place in between is tried.
  double min_overlap = 0.25;   ///< [-] Of the cells of `to`; loops meet with their edges.
  double min_inliers = 0.75;   ///< [-] Heights that agree.
  int min_faces = 60;          ///< Submaps with fewer are told apart by their heights alone.
  double min_faces_met = 0.5;  ///< [-] Of the faces where the other one knows the place.
  /// [-] Places with so much fewer faces that meet are looked at too (along a corridor it is fewer
  /// because less overlaps); when they fit as well, the match does not tell the two apart.
  double rival_lead = 0.4;
  /// [m] Without faces the heights are laid over each other no further than this.
  double max_plain_reach_m = 2.0;
  double max_plain_yaw_rad = 0.3;  ///< [rad]
  /// [m], [rad] Submaps are not stiff: they drifted while they were made.
  double stiffness_m = 0.03;
  double stiffness_rad = 0.004;
};

/// One of the two submaps: its surface in its own frame and what is known of it.
struct LoopSide {
  const HeightMap& surface;
  const Footprint& footprint;
  const Faces& faces;
};

/// One comparison and its evidence.
struct LoopMatch {
  LevelPose T_from_to;
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();  ///< As in GraphConstraint.
  FaceAgreement faces;                                    ///< Of the side that agrees less.
  Registration registration;
  bool accepted = false;
  std::string why;  ///< One line: why it was refused.
};

/// Lays `to` over `from`, believed at T_from_to with this covariance (of to's origin, along from's
/// axes): where what stands up meets, then by the heights (register_map).
[[nodiscard]] LoopMatch match_loop(const LoopSide& to, const LoopSide& from,
                                   const LevelPose& T_from_to, const Eigen::Matrix4d& covariance,
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
