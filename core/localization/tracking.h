#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/localization/tracking_map.h"
#include "core/localization/tracking_points.h"

namespace cairn {

struct TrackingConfig {
  SurfacePointsConfig points;
  TrackingMapConfig map;
  /// [m] Of way: what was not seen for so long is forgotten. Coming back later is a matter of the
  /// long-term map.
  double remember_m = 15.0;
  /// A sweep is kept when the robot went this far [m] or turned this much [rad] since the last.
  double keep_every_m = 0.10;
  double keep_every_rad = 0.05;
  double surface_sigma_m = 0.03;  ///< [m] Of a point off the surface that it belongs to.
  /// [-] Neighbouring points err together: this many count as one.
  double points_per_opinion = 4.0;
  double agree_m = 0.10;        ///< [m] A point nearer to the surface than this agrees.
  double min_agreement = 0.65;  ///< [0 … 1] Of the points near a surface.
  std::size_t min_points = 15;  ///< And so many at least.
  /// A step is never surer than this [m, rad]: where the match tells nothing it stays as it is.
  double step_floor_m = 0.01;
  double step_floor_rad = 0.01;
  /// [-] Sigmas of the prediction. A step further off is believed only when the next sweep says the
  /// same: a laser that tips for a moment meets other surfaces.
  double surprise = 3.0;
  /// [m] Robust weights begin with this scale and end with agree_m.
  double begin_scale_m = 0.4;
  int iterations = 12;
};

/// What a sweep told.
struct TrackedStep {
  Pose T_local_robot;  ///< As predicted where it is not matched.
  bool matched = false;
  bool surprising = false;      ///< It matched, but is not believed yet.
  bool kept = false;            ///< The sweep became part of the surfaces.
  double agreement = 0.0;       ///< [0 … 1] Of the points that lie near a surface.
  std::size_t near_points = 0;  ///< Points that lie near a surface.
  /// Of (x [m], y [m], yaw [rad]), of the match alone: (near) zero in directions that the surfaces
  /// do not show.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

/// Local tracking: lays each sweep of a level laser onto the surfaces met lately, seen from above
/// (point to implicit surface, Gauss-Newton with robust weights and the prediction as prior). It
/// makes the robot's way between two places surer than wheels and gyro do; it never jumps back to
/// what was seen long ago. Surfaces count as upright: for lasers that meet walls, not slopes.
/// Pure; not thread-safe.
class Tracking {
 public:
  explicit Tracking(const TrackingConfig& config) : config_(config), map_(config.map) {}

  /// Where the robot is, by a sweep; the sweep becomes part of the surfaces. `predicted`: the last
  /// answer moved on by dead reckoning; `covariance` that of the move, of (x, y, yaw).
  /// A prediction that is not finite is answered as it came.
  TrackedStep track(const Scan& scan, const LaserSpec& laser, const Pose& predicted,
                    const Eigen::Matrix3d& covariance);
  /// The surfaces are no longer where the robot is.
  void forget() {
    map_.clear();
    surprise_.reset();
  }

  /// Sweeps in a row that did not match although there was something to match them with.
  [[nodiscard]] int misses() const { return misses_; }

 private:
  struct Fit;
  [[nodiscard]] Fit fit(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& predicted,
                        const Eigen::Matrix3d& information, const Eigen::Vector3d& start) const;
  [[nodiscard]] Fit best_fit(const std::vector<SurfacePoint>& points,
                             const Eigen::Vector3d& predicted,
                             const Eigen::Matrix3d& information) const;
  [[nodiscard]] bool believed(const Eigen::Vector3d& off, const Eigen::Matrix3d& information);
  void judge(Fit& fit, const std::vector<SurfacePoint>& points) const;
  [[nodiscard]] bool good(const Fit& fit) const;
  bool keep(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& place);

  TrackingConfig config_;
  TrackingMap map_;
  Eigen::Vector3d last_place_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d last_kept_ = Eigen::Vector3d::Zero();
  double way_m_ = 0.0;
  double forgotten_m_ = 0.0;
  int misses_ = 0;
  std::optional<Eigen::Vector3d> surprise_;  ///< By how much the last sweep was off, if by much.
};

}  // namespace cairn
