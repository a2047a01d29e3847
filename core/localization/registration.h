#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "core/localization/refine.h"
#include "core/localization/search.h"
#include "core/map/height_map.h"
#include "core/pose/pose.h"

namespace cairn {

enum class RegistrationMode {
  thesis,  ///< T4.3.3 as it is written: the weighted mean of the good matches, z from the map.
  cairn,   ///< The best match, refined within its cell, accepted by evidence.
};

struct RegistrationConfig {
  RegistrationMode mode = RegistrationMode::cairn;
  SearchWindow window;
  /// Searched once more, when the narrow search gave nothing that can be accepted.
  SearchWindow wide_window{.reach_m = 4.0, .yaw_rad = 0.5236, .yaw_step_rad = 8.7e-3};
  bool widen = true;
  /// [m] The z of the prior may be off by this much.
  double z_window_m = 1.5;
  /// [-] Normalised score from which a match is a good one (thesis).
  double good_match = 0.7;
  /// [mm] So far up a face is looked at in any case (cairn), see LongTermRelief.
  int face_mm = 350;
  /// [m] The ground that a face stands on is looked for this far around it.
  double ground_reach_m = 0.75;
  /// [m] Beside a wall often no ground was seen: so far around another is looked for,
  double far_ground_reach_m = 2.0;
  int ground_rise_mm = 350;  ///< [mm] which counts when it is lower than ground can be there.
  RefineConfig refine;

  // What makes a match acceptable.
  double min_overlap = 0.35;      ///< [-] Of the short-term map's cells, known in both.
  int min_overlap_cells = 150;    ///< And so many at least.
  double min_inliers = 0.75;      ///< [-] Of the overlap, agreeing within 3 σ.
  double max_residual_mm = 60.0;  ///< [mm]
  /// [-] See Refinement. What stands there and is not on the map, or no more, misfits a little; a
  /// displaced part of the map is told by discord.
  double max_misfit = 1.2;
  double max_discord = 4.5;  ///< [-] See Refinement.
  /// [-] The same where the match would move the robot by more than `small_step_m` or
  /// `small_step_rad`: a wrong small step does little harm, and is put right by the next.
  double max_bold_discord = 3.0;
  double small_step_m = 0.15;
  double small_step_rad = 0.02;
  /// [-] Basins whose score is worse than the best one's by less than this, in parts of their own,
  /// are refined as well: what they are worth shows only then.
  double min_distinctness = 0.12;
  /// [-] A place whose χ² (prior included) is higher than the best one's by less is a rival: 25 is
  /// five sigmas. Within the narrow window the answer tells only what all rivals agree on; what
  /// the wide search finds must have none.
  double min_margin = 25.0;
  /// [-] Squared Mahalanobis distance from the prior (4 degrees of freedom: 0.1 % are beyond 18.5).
  double max_innovation = 18.5;
  double prior_supported = 9.5;  ///< [-] The same (5 % are beyond), for `supports_prior`.
  /// [-] The same for what only the wide search finds: ten sigmas. A robot that knows that it is
  /// lost puts it to infinity.
  double max_wide_innovation = 100.0;
  double min_wide_distinctness = 0.1;  ///< [-] Nothing but the match speaks for it.
  double prior_floor_m = 0.03;         ///< [m] A prior is never surer than this, in x, y and z,
  double prior_floor_rad = 0.002;      ///< [rad] and yaw.
};

/// Where a short-term map is believed to lie.
struct RegistrationPrior {
  Pose T_site_submap;   ///< Level: roll and pitch are ignored.
  Pose T_submap_robot;  ///< Where the robot is now; turns are made around this point.
  /// Of the robot's (x, y, z [m], yaw [rad]) in the site; the map is stiff and moves along.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();
  /// [rad] Of the robot's roll and pitch while it made the map: what lies far from it is off by so
  /// much of the distance.
  double incline_sigma_rad = 0.0;
};

/// The answer and its evidence.
struct Registration {
  Pose T_site_submap;  ///< The prior's where it is not accepted.
  Pose T_site_robot;   ///< T_site_submap · T_submap_robot, with roll and pitch of the latter.
  /// Of the robot's (x, y, z, yaw) after the match. Where the match tells nothing it is the
  /// prior's.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();
  /// Of the match alone: (near) zero in directions that the ground does not show.
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  Pose best_cell;             ///< T_site_submap of the best whole-cell match.
  double overlap = 0.0;       ///< [0 … 1] Share of the short-term map's cells known in both.
  double score = 0.0;         ///< [mm] Mean truncated height difference of the best match.
  double second_best = 0.0;   ///< [mm] The same of the best match in another basin; 0: none.
  double distinctness = 0.0;  ///< [0 … 1] 1 - score / second_best.
  double inliers = 0.0;       ///< [0 … 1]
  double residual_mm = 0.0;
  double misfit = 0.0;   ///< [-] See Refinement.
  double discord = 0.0;  ///< [-] See Refinement.
  double margin = 0.0;   ///< [-] How much less likely the next place is, as a difference of χ².
  double innovation = 0.0;           ///< [-] Squared Mahalanobis distance between match and prior.
  bool position_observable = false;  ///< The match tells x and y better than ±10 cm.
  bool comparable = false;           ///< The maps overlap enough to agree or to disagree.
  /// They match where the prior has them, most of them: also where that is refused as a correction
  /// it does not speak against the prior.
  bool supports_prior = false;
  bool wide = false;  ///< It took the wide window.
  bool accepted = false;
  std::string why;  ///< One line: why it was refused, or what is special.
};

/// Registers a short-term map against the long-term map around the prior (T2.2.3, T4.3.3). Refused
/// matches leave the prior as it is. Never fails: unusable input (not finite, empty, larger than
/// kMaxRegistrationCells) is refused. Requires: equal cell sizes.
[[nodiscard]] Registration register_map(const HeightMap& short_term, const RegistrationPrior& prior,
                                        const HeightMap& long_term,
                                        const RegistrationConfig& config);

/// [cells] Largest side of a short-term map's known part.
inline constexpr int kMaxRegistrationCells = 768;

}  // namespace cairn
