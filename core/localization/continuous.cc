#include "core/localization/continuous.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/common/angle.h"

namespace cairn {
namespace {

/// Each map's axes are turned by this against the last one's. Walls that run along a grid's axes
/// all meet their cells at the same place; at odd angles such errors average out.
constexpr double kTurnBetweenMapsRad = 0.4;

Pose level(const Pose& pose) { return {pose.x_m, pose.y_m, pose.z_m, 0.0, 0.0, pose.yaw_rad}; }

Pose carried(const Eigen::Isometry3d& T, const Pose& pose) {
  return from_transform(T * to_transform(pose));
}

std::int32_t to_mm(double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); }

/// Hits beyond the range still tell that the way to them is free.
void shorten(std::vector<Beam>& beams, double range_m) {
  for (Beam& beam : beams) {
    const Eigen::Vector3d along = beam.end_m - beam.origin_m;
    if (!beam.hit || along.squaredNorm() <= range_m * range_m) continue;
    beam.end_m = beam.origin_m + along.normalized() * range_m;
    beam.hit = false;
  }
}

}  // namespace

ContinuousLocalization::ContinuousLocalization(const ContinuousConfig& config)
    : config_(config), integrator_(config.sensor_model) {
  assert(config.overlapping_maps >= 1 && config.overlapping_maps <= 16);
}

void ContinuousLocalization::move(const Pose& T_site_robot) {
  if (!is_finite(T_site_robot)) return;
  if (placed_) {
    const double way_m =
        std::hypot(T_site_robot.x_m - T_site_robot_.x_m, T_site_robot.y_m - T_site_robot_.y_m,
                   T_site_robot.z_m - T_site_robot_.z_m);
    const double turn_rad = std::abs(wrap_angle(T_site_robot.yaw_rad - T_site_robot_.yaw_rad));
    progress_ += way_m / config_.mature_distance_m + turn_rad / config_.mature_turn_rad;
  }
  T_site_robot_ = T_site_robot;
  placed_ = true;
  const double spacing = 1.0 / config_.overlapping_maps;
  if (maps_.empty() || progress_ - maps_.back().begun_at >= spacing) begin_map();
}

void ContinuousLocalization::begin_map() {
  // Whoever never asks for a registration must not fill the memory.
  if (maps_.size() > static_cast<std::size_t>(config_.overlapping_maps)) maps_.pop_front();
  Pose T_site_submap = level(T_site_robot_);
  T_site_submap.yaw_rad = wrap_angle(kTurnBetweenMapsRad * begun_++);
  maps_.push_back({HeightMap(config_.cell_size_mm), T_site_submap, progress_});
}

void ContinuousLocalization::take_scan(const Scan& scan, const LaserSpec& laser,
                                       const Pose& T_site_robot, double incline_sigma_rad) {
  if (!is_finite(T_site_robot)) return;
  for (ShortTermMap& map : maps_) {
    const Pose T_submap_robot = carried(to_transform(map.T_site_submap).inverse(), T_site_robot);
    std::vector<Beam> beams = beams_in_site(scan, laser, T_submap_robot, config_.mapping_range_m);
    shorten(beams, config_.mapping_range_m);
    std::optional<std::int32_t> ground_mm;
    if (laser.ground_along_beam) ground_mm = to_mm(T_submap_robot.z_m);
    integrator_.integrate(map.surface, beams, ground_mm, nullptr);
    ++map.scans;
    map.incline_rad2 += incline_sigma_rad * incline_sigma_rad;
  }
}

bool ContinuousLocalization::mature() const {
  return !maps_.empty() && maps_.front().scans > 0 && progress_ - maps_.front().begun_at >= 1.0;
}

std::optional<Registration> ContinuousLocalization::localize(const HeightMap& long_term,
                                                             const Eigen::Matrix4d& covariance) {
  if (!mature()) return std::nullopt;
  const ShortTermMap map = std::move(maps_.front());
  maps_.pop_front();
  Registration answer = register_map_of(map, long_term, covariance);
  judge(map, answer);
  if (!answer.accepted) {
    answer.T_site_submap = map.T_site_submap;
    answer.T_site_robot = T_site_robot_;
    answer.covariance = covariance;
  }
  if (answer.accepted) {
    apply(answer);
  } else {
    refuse(answer);
  }
  return answer;
}

Registration ContinuousLocalization::register_map_of(const ShortTermMap& map,
                                                     const HeightMap& long_term,
                                                     const Eigen::Matrix4d& covariance) const {
  RegistrationPrior prior;
  prior.T_site_submap = map.T_site_submap;
  prior.T_submap_robot = carried(to_transform(map.T_site_submap).inverse(), T_site_robot_);
  prior.covariance = covariance;
  prior.incline_sigma_rad = std::sqrt(map.incline_rad2 / static_cast<double>(map.scans));
  RegistrationConfig config = config_.registration;
  config.refine.registered_times = config_.overlapping_maps;
  if (state_ == LocalizationState::lost) {
    config.wide_window = config_.lost_window;
    config.max_wide_innovation = std::numeric_limits<double>::infinity();
  }
  return register_map(map.surface, prior, long_term, config);
}

/// What is far from expected must be seen twice, and so must everything when the robot is lost:
/// then by maps without a common scan, or one map's fault would confirm itself.
void ContinuousLocalization::judge(const ShortTermMap& map, Registration& answer) {
  if (!answer.accepted || config_.registration.mode == RegistrationMode::thesis) return;
  const bool lost = state_ == LocalizationState::lost;
  if (!lost && !answer.wide && answer.innovation <= config_.confirm_innovation) return;
  answer.accepted = false;
  if (lost && !answer.position_observable) {
    answer.why = "lost, and x and y are not observable here";
    return;
  }
  const bool must_be_independent = lost || answer.wide;
  const bool independent = pending_ && map.begun_at >= pending_->seen_until;
  answer.why = "waits for another map to confirm it";
  if (pending_ && must_be_independent && !independent) return;
  answer.accepted = pending_ && agrees(*pending_, answer);
  if (answer.accepted) {
    answer.why = "confirmed by another map";
    return;
  }
  pending_ = Pending{
      to_transform(level(answer.T_site_robot)) * to_transform(level(T_site_robot_)).inverse(),
      answer.covariance, progress_};
}

bool ContinuousLocalization::agrees(const Pending& pending, const Registration& answer) const {
  const Pose before = carried(pending.T_corrected_site, level(T_site_robot_));
  const Pose& now = answer.T_site_robot;
  Eigen::Vector4d apart;
  apart << now.x_m - before.x_m, now.y_m - before.y_m, now.z_m - before.z_m,
      wrap_angle(now.yaw_rad - before.yaw_rad);
  Eigen::Matrix4d covariance = pending.covariance + answer.covariance;
  covariance.diagonal() += Eigen::Vector4d(4e-4, 4e-4, 4e-4, 1e-4);
  return apart.dot(covariance.ldlt().solve(apart)) <= config_.agreement;
}

/// A place of which there is no map says nothing of where the robot is, and what matches best where
/// the robot is believed to be does not speak against that.
void ContinuousLocalization::refuse(const Registration& answer) {
  if (!answer.comparable || answer.supports_prior) return;
  ++refusals_;
  const bool lost = state_ == LocalizationState::lost || refusals_ >= config_.refusals_until_lost;
  state_ = lost ? LocalizationState::lost : LocalizationState::unsure;
}

void ContinuousLocalization::apply(const Registration& answer) {
  const Eigen::Isometry3d T_corrected_site =
      to_transform(level(answer.T_site_robot)) * to_transform(level(T_site_robot_)).inverse();
  for (ShortTermMap& map : maps_) map.T_site_submap = carried(T_corrected_site, map.T_site_submap);
  const Pose& robot = answer.T_site_robot;
  T_site_robot_ = {
      robot.x_m,    robot.y_m, robot.z_m, T_site_robot_.roll_rad, T_site_robot_.pitch_rad,
      robot.yaw_rad};
  pending_.reset();
  refusals_ = 0;
  state_ = LocalizationState::localized;
}

}  // namespace cairn
