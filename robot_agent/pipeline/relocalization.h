#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "core/localization/site_search.h"
#include "core/map/update.h"
#include "core/sensor/laser.h"
#include "robot_agent/pipeline/mapper_config.h"

namespace cairn::agent {

/// How a lost robot finds itself again (T2.2.3: "a more thorough search"): from where it noticed
/// that it is lost it maps anew, in its local frame, and searches the whole replica for that map,
/// again and again as the map grows. Places look alike: it has found itself only when two maps that
/// share no scan say the same.
class Relocalization {
 public:
  explicit Relocalization(const MapperConfig& config);

  /// The robot is lost from here on; what was seen before counts no more.
  void begin(const Pose& T_local_robot);
  /// The replica has changed since it was last searched.
  void map_changed() { search_.reset(); }

  void move(const Pose& T_local_robot);
  void take_scan(const Scan& scan, const LaserSpec& laser, double range_m);

  /// Searches when there is enough new to search with. Costs up to seconds in a large site. What is
  /// found once is not accepted yet, but waits for a second map that agrees.
  [[nodiscard]] std::optional<SiteMatch> find(const HeightMap& site);

  [[nodiscard]] std::size_t searches() const { return searches_; }

 private:
  void begin_map();
  void confirm(SiteMatch& match);
  [[nodiscard]] bool agrees(const Pose& T_site_robot) const;

  MapperConfig config_;
  ScanIntegrator integrator_;
  HeightMap seen_;  ///< In the local frame.
  Pose T_local_robot_;
  double progress_ = 0.0;     ///< Way and turning since the last search; 1 is enough.
  double since_begin_ = 0.0;  ///< The same since the beginning.
  std::size_t scans_ = 0;
  std::size_t searches_ = 0;
  std::optional<Pose> T_site_local_;    ///< What the last map that was found said.
  std::unique_ptr<SiteSearch> search_;  ///< Prepared for the replica as it is.
};

}  // namespace cairn::agent
