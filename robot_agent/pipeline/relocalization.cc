#include "robot_agent/pipeline/relocalization.h"

#include <cmath>

#include "core/common/angle.h"
#include "robot_agent/pipeline/submap_frame.h"

namespace cairn::agent {

namespace {

/// [-] A map older than this many searches has drifted: it begins anew.
constexpr double kWornOut = 8.0;

}  // namespace

Relocalization::Relocalization(const MapperConfig& config)
    : config_(config), integrator_(config.sensor_model), seen_(config.cell_size_mm) {}

void Relocalization::begin(const Pose& T_local_robot) {
  seen_ = HeightMap(config_.cell_size_mm);
  T_local_robot_ = T_local_robot;
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
  if (!match.accepted && since_begin_ > kWornOut) begin(T_local_robot_);
  return match;
}

}  // namespace cairn::agent
