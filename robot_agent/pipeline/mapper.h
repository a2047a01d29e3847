#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/localization/ground_tracking.h"
#include "core/pose/dead_reckoning.h"
#include "core/pose/incline_trust.h"
#include "core/sensor/laser.h"
#include "proto/sync/evidence_sender.h"
#include "robot_agent/pipeline/drift.h"
#include "robot_agent/pipeline/gyro_check.h"
#include "robot_agent/pipeline/mapper_config.h"
#include "robot_agent/pipeline/relocalization.h"
#include "robot_agent/pipeline/replica.h"
#include "robot_agent/pipeline/site_localization.h"
#include "robot_agent/pipeline/submap_writer.h"

namespace cairn::agent {

/// The robot's map making: pose module, scans, localization, evidence submaps. What it writes goes
/// through the EvidenceSender, which owns the submaps until the server holds them.
///
/// Frames: `local` is where the robot was switched on; the robot's pose in it comes from dead
/// reckoning and local tracking alone and never jumps. `T_site_local` says where that lies in the
/// site and changes with each correction.
class Mapper {
 public:
  Mapper(const MapperConfig& config, std::vector<LaserSpec> lasers, const Pose& T_site_start,
         std::uint64_t boot, proto::EvidenceSender& evidence);

  void take_motion(const MotionReading& reading);
  void take_scan(const Scan& scan);
  /// Closes the open submap: nothing more will come.
  void finish();

  /// Long-term tiles from the server: they replace the replica's, and own submaps that a tile does
  /// not hold yet are laid on it again.
  void take_tiles(const std::vector<GivenTile>& tiles);
  /// The server's pose graph moved these earlier submaps of this boot. In one step they are placed
  /// anew in the replica, and what is newer than the newest of them moves along stiffly: later
  /// submaps, the robot, its short-term maps. When that is more than a cell, the open submap is
  /// closed (its head says its old place; the server moves it by its link as it moved the others)
  /// and the next one begins at the new place.
  void move_submaps(const std::vector<std::pair<std::uint32_t, SubmapPose>>& poses);

  [[nodiscard]] const Pose& pose() const { return T_site_robot_; }
  [[nodiscard]] double position_sigma_m() const;
  /// While lost the pose is a guess, no submap is open and none begins.
  [[nodiscard]] LocalizationState localization() const { return localization_.state(); }
  /// One line for people: what the state rests on.
  [[nodiscard]] const std::string& localization_why() const { return localization_.why(); }
  [[nodiscard]] std::uint64_t corrections_accepted() const { return localization_.accepted(); }
  [[nodiscard]] std::uint64_t corrections_refused() const { return localization_.refused(); }

  /// What the robot holds true of a cell of the site: the open submap, else the replica.
  [[nodiscard]] Cell cell(CellIndex site_cell) const;
  [[nodiscard]] int cell_size_mm() const { return config_.cell_size_mm; }
  [[nodiscard]] const SensorModel& sensor_model() const { return config_.sensor_model; }
  [[nodiscard]] std::int64_t beams() const { return writer_.beams(); }
  [[nodiscard]] double distance_m() const { return dead_reckoning_.distance_m(); }
  /// Null while the robot is lost.
  [[nodiscard]] const Submap* open_submap() const { return writer_.open(); }
  /// The robot in the local frame, free of corrections against older maps.
  [[nodiscard]] const Pose& T_local_robot() const { return dead_reckoning_.pose(); }
  [[nodiscard]] const Replica& replica() const { return replica_; }

  /// [m] The robot keeps its own map this far around it.
  static constexpr double kKeepRadiusM = 150.0;

 private:
  /// Where a submap begins in the local frame.
  struct Mark {
    std::uint32_t sequence = 0;
    Pose T_local_submap;
    double begun_m = 0.0;  ///< Way driven when it began.
  };

  void place_robot();
  [[nodiscard]] double incline_sigma_rad(const LaserSpec& laser) const;
  [[nodiscard]] double trusted_range_m(const LaserSpec& laser, double incline_sigma_rad) const;
  /// The robot at a scan's time, as well as the known ground tells; its height for good.
  struct Stance {
    Pose T_site_robot;
    double incline_sigma_rad = 0.0;
  };
  Stance stand_on_ground(const Scan& scan, const LaserSpec& laser);
  /// Whether a laser still cuts the world where it did: level, and the robot in one plane.
  [[nodiscard]] bool in_section(const LaserSpec& laser);
  void track(const Scan& scan, const LaserSpec& laser);
  void leave_section();
  void turn_submaps_over();
  [[nodiscard]] bool submap_full() const;
  void begin_submap();
  [[nodiscard]] SubmapWriter::Telling telling();
  void link_submap();
  [[nodiscard]] SubmapLink way_link() const;
  [[nodiscard]] std::optional<SubmapLink> map_link() const;
  void close_submap();
  void age_submaps();
  void forget_far_tiles();
  void localize();
  void become_lost();
  void search_site();
  [[nodiscard]] SiteLocalization::Surroundings surroundings() const;
  void correct(const Pose& T_site_robot, const Eigen::Matrix4d& covariance);
  /// Moves the robot in the site without any motion.
  void put(const Pose& T_site_robot);

  MapperConfig config_;
  std::vector<LaserSpec> lasers_;
  DeadReckoning dead_reckoning_;  ///< In the local frame.
  Pose T_site_local_;
  Pose T_site_robot_;
  Drift since_correction_;
  Drift since_submap_;    ///< Since the open submap began …
  Drift since_previous_;  ///< … the one before it …
  Drift since_whole_;     ///< … and the last one of which all was told.
  InclineTrust incline_trust_;
  GroundTracking ground_tracking_;
  Eigen::Vector2d missed_incline_rad_ = Eigen::Vector2d::Zero();  ///< Of roll and pitch, lately.
  Tracking tracking_;
  GyroCheck gyro_check_;
  std::optional<double> section_z_m_;  ///< Height at which the tracked surfaces were met.
  SubmapWriter writer_;
  Replica replica_;
  SiteLocalization localization_;
  Relocalization relocalization_;
  std::vector<Mark> young_;   ///< Submaps that are not old yet, the open one last.
  bool chained_ = false;      ///< The next submap hangs on the last of `young_`.
  bool was_chained_ = false;  ///< So did the open one.
  int whole_ = 0;  ///< [submaps] Of which all was told, one after the other on known ground.
  double submap_turned_rad_ = 0.0;
  MonotonicTime last_motion_{};
};

}  // namespace cairn::agent
