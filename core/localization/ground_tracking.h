#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/common/time.h"
#include "core/map/height_map.h"
#include "core/pose/pose.h"
#include "core/sensor/laser.h"

namespace cairn {

struct GroundTrackingConfig {
  double reach_m = 8.0;  ///< [m] Hits further away are not asked.
  /// [m] Of a hit's height over the ground of the map: range noise, and what lies within a cell.
  double hit_sigma_m = 0.03;
  /// [m] A cell counts as ground when it and its neighbours lie this near to one plane.
  double plane_m = 0.03;
  /// [m/m] and when that is no steeper.
  double steepest = 0.6;
  /// A sweep needs so many hits on known ground, and of them this share must agree: what stands
  /// there that is not on the map disagrees.
  int min_hits = 12;
  double min_share = 0.6;
  /// A sweep with less than this share of its hits near known ground, of twice `min_hits` above or
  /// below it, leaves the incline in doubt: the robot tips, or something stands there.
  double doubt_share = 0.4;
  /// Neighbouring hits err together: a sweep weighs no more than so many hits that do not.
  double most_hits = 12.0;
  /// [m] Lever by which a robot that tips over a step lifts its middle unseen.
  double tip_lever_m = 0.15;
  /// [m] The height is never believed better than this, nor worse than that: off by more it is a
  /// registration's work.
  double least_sigma_m = 0.005;
  double most_sigma_m = 0.15;
  /// [m] A step in height by more than this must be asked for by two sweeps in a row: one alone may
  /// have met the side of something flat.
  double sudden_m = 0.1;
};

/// What is wrong with the height and the incline of a robot's pose.
struct Unevenness {
  double z_m = 0.0;
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double incline_sigma_rad = 0.0;  ///< Of roll and pitch, once that is put right.
};

/// Keeps a robot's height, roll and pitch by the ground that its map knows: each sweep of a laser
/// is laid on it as a whole. Inclinometers lag behind a robot that climbs a kerb, and so does the
/// height that is reckoned from them (T3.2, Eq. 8); on known ground this undoes both at once,
/// where a registration of a whole short-term map (T4.3.3) comes some metres later.
class GroundTracking {
 public:
  explicit GroundTracking(const GroundTrackingConfig& config)
      : config_(config), z_sigma_m_(config.least_sigma_m) {}

  /// The robot went on; roll and pitch are known to `incline_sigma_rad` [rad] and change by
  /// `tip_rad` [rad].
  void move(double way_m, double tip_rad, double incline_sigma_rad);
  /// The pose's height is this good from now on [m].
  void restart(double sigma_m);

  /// Lays a sweep on the map. nullopt when the map does not know the ground there, or too much
  /// disagrees. What is returned is expected to be applied: z for good, roll and pitch to the
  /// sweep.
  [[nodiscard]] std::optional<Unevenness> lay(const Scan& scan, const LaserSpec& laser,
                                              const Pose& T_site_robot, const HeightMap& map,
                                              double incline_sigma_rad);

  [[nodiscard]] double z_sigma_m() const { return z_sigma_m_; }
  /// Whether the last sweep that met known ground met it where it should not be.
  [[nodiscard]] bool in_doubt() const { return in_doubt_; }

 private:
  [[nodiscard]] bool confirmed(double step_m);

  GroundTrackingConfig config_;
  double z_sigma_m_;
  bool in_doubt_ = false;
  std::optional<double> sudden_step_m_;  ///< What the last sweep asked for and did not get.
};

}  // namespace cairn
