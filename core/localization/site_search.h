#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "core/localization/registration.h"
#include "core/localization/site_ground.h"
#include "core/map/height_map.h"
#include "core/pose/pose.h"

namespace cairn {

struct SiteSearchConfig {
  SiteGroundConfig ground;
  double reach_m = 20.0;  ///< [m] The short-term map counts so far from the robot.
  /// [rad] Half of it moves nothing within reach by more than a cell. [Limit: 0.002 … 0.2]
  double yaw_step_rad = 0.0125;
  int faces = 256;           ///< Cells of what stands up that take part, at most,
  int flats = 128;           ///< and of the ground; together ≤ kMostTopPoints.
  double far_sigma = 0.006;  ///< [m/m] Heights are known less well with distance (tilt).

  // What makes a match acceptable.
  int min_cells = 150;  ///< The short-term map must show so many.
  /// [mm] Mean difference with one cell of tolerance, see SiteMatch::bound_mm.
  double max_score_mm = 7.5;
  /// [mm] Places that are worse by more, with one cell of tolerance, are other places beyond doubt.
  double min_lead_mm = 8.0;
  /// [-] The others must score this much worse without the tolerance, in parts of their score.
  double min_distinctness = 0.35;
  double min_gap_mm = 2.0;   ///< [mm] And this much with it.
  double max_unknown = 0.4;  ///< [-] Share of the cells that the long-term map does not know.
  double max_blocked = 0.3;  ///< [-] Share of its sight lines that are blocked there.
  RegistrationConfig registration;  ///< Evidence asked of the last step; windows are not used.

  // Written bounds of the work.
  std::size_t max_bounds = 1'000'000;  ///< Blocks of places.
  std::size_t max_places = 32;         ///< Places that might be the robot's.
};

/// Where in the site the robot is, and why that is believed. Scores are means of height
/// differences over the cells that take part, each truncated.
struct SiteMatch {
  Pose T_site_robot;                                         ///< Of use when accepted.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();  ///< Of x, y, z [m], yaw [rad].
  double score_mm = 0.0;                                     ///< [mm] At the best place.
  /// [mm] At the best one elsewhere, of those that come near by the bounds; infinite without any.
  double second_best_mm = 0.0;
  double bound_mm = 0.0;  ///< [mm] The best place's score with one cell of tolerance.
  /// [mm] The same of the next place; without one that comes near, what it scores at least.
  double second_bound_mm = 0.0;
  double unknown = 0.0;       ///< [0 … 1] Share that the long-term map does not know there.
  double blocked = 0.0;       ///< [0 … 1] Sight lines that the long-term map says are blocked.
  Registration registration;  ///< The last step, where it came to that.
  std::size_t bounds = 0;     ///< Work done: blocks of places bounded,
  std::size_t places = 0;     ///< and places looked at.
  bool accepted = false;
  std::string why;  ///< One line: why it was refused.
};

/// Finds a robot that does not know where it is: restarted without a pose, carried away, or wrong
/// for long: the "more thorough search" that the thesis asks for (T2.2.3, T4.3.3). Every place of
/// the map and every turn is tried, by branch and bound on truncated height differences; roll and
/// pitch are known, and z follows from the ground under the robot's place.
///
/// What is exact: no cell and turn is passed over that scores, with one cell of tolerance, within
/// min_lead_mm of the best; those are compared without the tolerance. What is not searched: places
/// farther than SiteGroundConfig::far_floor_reach_m from any ground that the map knows, and levels
/// above 0.
///
/// Prepared once for a long-term map, which is copied as far as needed; then `find` is const and
/// may be called from
/// several threads.
class SiteSearch {
 public:
  /// `disc`: only robots in it are found. Never fails: with a map that cannot be searched `find`
  /// refuses everything with the reason.
  explicit SiteSearch(const HeightMap& long_term, const SiteSearchConfig& config = {},
                      const std::optional<SiteDisc>& disc = std::nullopt);
  ~SiteSearch();
  SiteSearch(SiteSearch&&) noexcept;
  SiteSearch& operator=(SiteSearch&&) noexcept;

  /// Where in the site, or in a disc of it, the robot is that made `short_term` and now stands at
  /// T_submap_robot in it. Refuses bad input, a map that fits nowhere, and one that fits in several
  /// places. Requires: the long-term map's cell size.
  [[nodiscard]] SiteMatch find(const HeightMap& short_term, const Pose& T_submap_robot,
                               const std::optional<SiteDisc>& disc = std::nullopt) const;

 private:
  struct Prepared;
  std::unique_ptr<const Prepared> prepared_;
};

}  // namespace cairn
