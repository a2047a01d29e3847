#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/map/update.h"
#include "core/sensor/laser.h"
#include "proto/sync/evidence_sender.h"
#include "robot_agent/pipeline/mapper_config.h"

namespace cairn::agent {

/// Writes what the robot sees and stands on into the open evidence submap. The EvidenceSender owns
/// the submaps; the caller says when one begins and ends and where the robot is. Maps are made of
/// exact values, which stay here; the submap holds them as coarsely as they are told, so that robot
/// and server have the same bits, and a robot that stands still has nothing to tell.
class SubmapWriter {
 public:
  SubmapWriter(const MapperConfig& config, std::uint64_t boot, proto::EvidenceSender& evidence);

  /// Null while none is open.
  [[nodiscard]] const Submap* open() const { return open_; }
  /// What of the evidence goes into a submap.
  enum class Telling : std::uint8_t {
    all,
    news,  ///< Cells whose evidence agrees with the replica stay out of it.
  };
  /// Requires: none is open. `replica`: what the robot holds true of the site.
  void begin(const Pose& T_site_robot, const HeightMap& replica, Telling telling);
  /// How the open submap lies to the one before.
  void link(const SubmapLink& link) { open_->link = link; }
  /// Requires: one is open. Returns a copy of it; nullopt when there was nothing to tell: then it
  /// never was.
  std::optional<Submap> close();

  /// Requires of these: one is open. Scans are of `laser` and count up to `range_m`.
  void take_scan(const Scan& scan, const LaserSpec& laser, const Pose& T_site_robot,
                 double range_m);
  void touch_ground(const Pose& T_site_robot);

  [[nodiscard]] std::int64_t beams() const { return beams_; }

 private:
  void make_reference(const HeightMap& replica);
  void integrate(const std::vector<Beam>& beams, std::optional<std::int32_t> ground_mm);
  void note_seen_through(const std::vector<Contradiction>& contradictions);
  void lay_apron(const Scan& scan, const LaserSpec& laser, const Pose& T_submap_robot);
  void stand_on(const Eigen::Vector3d& p_submap_m, std::vector<CellIndex>& emptied);
  void hit_ground(double x_m, double y_m, double z_m, std::vector<CellIndex>& changed);
  void note(const std::vector<CellIndex>& changed);
  void tell_when_due(const Pose& T_site_robot, MonotonicTime now);
  void tell_noted();
  void tell_patient();
  [[nodiscard]] News::Worth worth_of(CellIndex cell) const;
  [[nodiscard]] std::int32_t ground_beside_mm(CellIndex cell, const Cell& own) const;
  [[nodiscard]] bool is_of_its_edge(CellIndex cell) const;
  void tell(const std::vector<CellIndex>& cells);
  void tell(EvidenceLayer layer, const std::vector<CellIndex>& cells);
  [[nodiscard]] Pose in_submap(const Pose& T_site_robot) const;

  MapperConfig config_;
  std::uint64_t boot_;
  proto::EvidenceSender& evidence_;
  ScanIntegrator integrator_;
  CellRules rules_;
  News news_;
  HeightMap reference_;     ///< The replica around the open submap, in that submap's frame.
  HeightMap surface_;       ///< Exact values of the open submap …
  HeightMap seen_through_;  ///< … and of its other layer.
  /// Cells changed and not told yet, some more than once. [Limit: what two lasers change in
  /// parked_telling_s]
  std::vector<CellIndex> noted_;
  std::vector<CellIndex> patient_;  ///< The same of what can wait. [Limit: in patience_s]
  MonotonicTime told_patient_at_{};
  Pose stood_at_;                ///< Where the robot came to stand …
  MonotonicTime stood_since_{};  ///< … and when.
  bool parked_ = false;
  MonotonicTime told_at_{};
  Submap* open_ = nullptr;
  Telling telling_ = Telling::all;
  bool told_ = false;  ///< Anything of the open submap.
  std::optional<CellIndex> last_touch_;
  bool apron_laid_ = false;
  std::int64_t beams_ = 0;
};

}  // namespace cairn::agent
