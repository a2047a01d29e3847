#include "robot_agent/pipeline/relocalization.h"

#include <cmath>

#include "core/common/angle.h"
#include "robot_agent/pipeline/submap_frame.h"

namespace cairn::agent {

namespace {

/// [-] A map older than this many searches has drifted: it begins anew.
constexpr double kWornOut = 8.0;
/// [m], [rad] Two sightings of one place differ by less: a cell or two, and the way between them.
constexpr double kSamePlaceM = 0.4;
constexpr double kSameHeadingRad = 0.06;

}  // namespace

Relocalization::Relocalization(const MapperConfig& config)
    : config_(config), integrator_(config.sensor_model), seen_(config.cell_size_mm) {}

void Relocalization::begin(const Pose& T_local_robot) {
  T_local_robot_ = T_local_robot;
  T_site_local_.reset();
  begin_map();
}

void Relocalization::begin_map() {
  seen_ = HeightMap(config_.cell_size_mm);
  progress_ = 0.0;
  since_begin_ = 0.0;
  scans_ = 0;
}

void Relocalization::move(const Pose& T_local_robot) {
  const double step =
      std::hypot(T_local_robot.x_m - T_local_robot_.x_m, T_local_robot.y_m - T_local_robot_.y_m) /
          config_.search_every_m +
      std::abs(wrap_angle(T_local_robot.yaw_rad - T_local_robot_.yaw_rad)) /
          config_.search_every_rad;
  progress_ += step;
  since_begin_ += step;
  T_local_robot_ = T_local_robot;
}

void Relocalization::take_scan(const Scan& scan, const LaserSpec& laser, double range_m) {
  const std::vector<Beam> beams =
      shortened(beams_in_site(scan, laser, T_local_robot_, range_m), range_m);
  std::optional<std::int32_t> ground_mm;
  if (laser.ground_along_beam) ground_mm = to_mm(T_local_robot_.z_m);
  integrator_.integrate(seen_, beams, ground_mm, nullptr);
  ++scans_;
}

std::optional<SiteMatch> Relocalization::find(const HeightMap& site) {
  if (progress_ < 1.0 || scans_ == 0 || site.tiles().empty()) return std::nullopt;
  progress_ = 0.0;
  ++searches_;
  if (search_ == nullptr) search_ = std::make_unique<SiteSearch>(site);
  SiteMatch match = search_->find(seen_, T_local_robot_);
  if (match.accepted) {
    confirm(match);
  } else if (since_begin_ > kWornOut) {
    begin_map();
  }
  return match;
}

void Relocalization::confirm(SiteMatch& match) {
  if (!agrees(match.T_site_robot)) {
    match.accepted = false;
    match.why = "found a place that fits; looks once more to be sure";
  }
  T_site_local_ = compose(match.T_site_robot, from_to(T_local_robot_, {}));
  begin_map();
}

bool Relocalization::agrees(const Pose& T_site_robot) const {
  if (!T_site_local_) return false;
  const Pose before = compose(*T_site_local_, T_local_robot_);
  return std::hypot(before.x_m - T_site_robot.x_m, before.y_m - T_site_robot.y_m) < kSamePlaceM &&
         std::abs(wrap_angle(before.yaw_rad - T_site_robot.yaw_rad)) < kSameHeadingRad;
}

}  // namespace cairn::agent
