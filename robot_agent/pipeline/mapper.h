#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/map/fold.h"
#include "core/map/update.h"
#include "core/pose/dead_reckoning.h"
#include "core/sensor/laser.h"
#include "proto/sync/evidence_sender.h"

namespace cairn::agent {

struct MapperConfig {
  int cell_size_mm = 125;
  SensorModel sensor_model;
  DeadReckoningConfig dead_reckoning;
  /// [m] Beams count this far: beyond it the error of the inclinometer exceeds a kerb's height.
  double mapping_range_m = 15.0;
  /// [rad] Error of roll and pitch while they do not change.
  double incline_sigma_rad = 0.004;
  /// [s] They lag this far behind while they do (T3.2); what is left of it fades at the same pace.
  double incline_lag_s = 0.4;
  /// [m] Beams also count no further than to where that error lifts their hits by this much: less
  /// than half a step, so that it makes no obstacles out of slopes.
  double height_sigma_m = 0.06;
  double submap_distance_m = 8.0;         ///< [m] A submap is closed after this much way
  double submap_turn_rad = 4.0 * 3.1416;  ///< [rad] or this much turning.
  /// [m] Half length and half width of the wheel base: where the wheels stand is ground.
  double wheel_x_m = 0.30;
  double wheel_y_m = 0.25;
  /// [m] At the start the ground in sight is taken as level within this radius, because no laser
  /// sees it; whoever sets the robot down vouches for it.
  double start_apron_m = 1.8;
};

/// The robot's map making: pose module, scans, evidence submaps. What it writes goes through the
/// EvidenceSender, which owns the submaps until the server holds them.
class Mapper {
 public:
  Mapper(const MapperConfig& config, std::vector<LaserSpec> lasers, const Pose& T_site_start,
         std::uint64_t boot, proto::EvidenceSender& evidence);

  void take_motion(const MotionReading& reading);
  void take_scan(const Scan& scan);
  /// Closes the open submap: nothing more will come.
  void finish();

  [[nodiscard]] const Pose& pose() const { return dead_reckoning_.pose(); }
  [[nodiscard]] double position_sigma_m() const;
  /// What the robot holds true of a cell of the site: the open submap, else what it mapped before.
  [[nodiscard]] Cell cell(CellIndex site_cell) const;
  [[nodiscard]] int cell_size_mm() const { return config_.cell_size_mm; }
  [[nodiscard]] const SensorModel& sensor_model() const { return config_.sensor_model; }
  [[nodiscard]] std::int64_t beams() const { return beams_; }
  [[nodiscard]] double distance_m() const { return dead_reckoning_.distance_m(); }

  /// [m] The robot keeps its own map this far around it.
  static constexpr double kKeepRadiusM = 150.0;

 private:
  void watch_incline(const Pose& before, MonotonicTime stamp);
  [[nodiscard]] double trusted_range_m(const LaserSpec& laser) const;
  void begin_submap();
  void close_submap();
  void make_reference();
  void integrate(const std::vector<Beam>& beams, bool ground_along_beam);
  void touch_ground();
  void stand_on(const Eigen::Vector3d& p_submap_m, std::vector<CellIndex>& emptied);
  void lay_apron(const Scan& scan, const LaserSpec& laser);
  void hit_ground(double x_m, double y_m, double z_m, std::vector<CellIndex>& changed);
  [[nodiscard]] Pose pose_in_submap() const;
  void forget_far_tiles();

  MapperConfig config_;
  std::vector<LaserSpec> lasers_;
  std::uint64_t boot_;
  proto::EvidenceSender& evidence_;
  DeadReckoning dead_reckoning_;
  ScanIntegrator integrator_;
  CellRules rules_;
  HeightMap site_map_;   ///< The robot's own long-term map: its closed submaps, folded.
  HeightMap reference_;  ///< The same around the open submap, in that submap's frame.
  Submap* open_ = nullptr;
  double submap_begin_m_ = 0.0;
  double submap_turned_rad_ = 0.0;
  double last_yaw_rad_ = 0.0;
  Eigen::Vector2d incline_rate_rad_s_ = Eigen::Vector2d::Zero();  ///< Roll and pitch, smoothed.
  MonotonicTime last_motion_{};
  std::optional<CellIndex> last_touch_;
  bool apron_laid_ = false;
  std::int64_t beams_ = 0;
};

}  // namespace cairn::agent
