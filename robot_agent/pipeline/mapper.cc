#include "robot_agent/pipeline/mapper.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cairn::agent {

namespace {

std::int32_t to_mm(double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); }

}  // namespace

Mapper::Mapper(const MapperConfig& config, std::vector<LaserSpec> lasers, const Pose& T_site_start,
               std::uint64_t boot, proto::EvidenceSender& evidence)
    : config_(config),
      lasers_(std::move(lasers)),
      boot_(boot),
      evidence_(evidence),
      dead_reckoning_(config.dead_reckoning, T_site_start),
      integrator_(config.sensor_model),
      rules_(config.sensor_model),
      site_map_(config.cell_size_mm),
      reference_(config.cell_size_mm),
      last_yaw_rad_(T_site_start.yaw_rad) {}

void Mapper::take_motion(const MotionReading& reading) {
  const Pose before = pose();
  if (!dead_reckoning_.update(reading)) return;
  watch_incline(before, reading.stamp);
  submap_turned_rad_ += std::abs(wrap_angle(pose().yaw_rad - last_yaw_rad_));
  last_yaw_rad_ = pose().yaw_rad;
  if (open_ != nullptr &&
      (dead_reckoning_.distance_m() - submap_begin_m_ > config_.submap_distance_m ||
       submap_turned_rad_ > config_.submap_turn_rad)) {
    close_submap();
  }
  if (open_ == nullptr) begin_submap();
  touch_ground();
}

void Mapper::watch_incline(const Pose& before, MonotonicTime stamp) {
  const double dt_s = to_seconds(stamp - std::exchange(last_motion_, stamp));
  if (dt_s <= 0.0) return;
  // Signed rates, smoothed: the noise of the readings is no motion.
  const Eigen::Vector2d rate((pose().roll_rad - before.roll_rad) / dt_s,
                             (pose().pitch_rad - before.pitch_rad) / dt_s);
  incline_rate_rad_s_ +=
      (rate - incline_rate_rad_s_) * (1.0 - std::exp(-dt_s / config_.incline_lag_s));
}

double Mapper::trusted_range_m(const LaserSpec& laser) const {
  if (laser.ground_along_beam) return config_.mapping_range_m;  // A plane world has no incline.
  return std::min(config_.mapping_range_m,
                  config_.height_sigma_m / (config_.incline_sigma_rad +
                                            incline_rate_rad_s_.norm() * config_.incline_lag_s));
}

void Mapper::take_scan(const Scan& scan) {
  if (scan.laser >= lasers_.size()) return;
  if (open_ == nullptr) begin_submap();
  const LaserSpec& laser = lasers_[scan.laser];
  const double range_m = trusted_range_m(laser);
  std::vector<Beam> beams = beams_in_site(scan, laser, pose_in_submap(), range_m);
  for (Beam& beam : beams) {  // Far hits still tell that the way to them is free.
    const Eigen::Vector3d along = beam.end_m - beam.origin_m;
    if (!beam.hit || along.squaredNorm() <= range_m * range_m) continue;
    beam.end_m = beam.origin_m + along.normalized() * range_m;
    beam.hit = false;
  }
  integrate(beams, laser.ground_along_beam);
  if (!apron_laid_ && !laser.ground_along_beam && scan.laser == 0) lay_apron(scan, laser);
}

void Mapper::integrate(const std::vector<Beam>& beams, bool ground_along_beam) {
  std::optional<std::int32_t> ground;
  if (ground_along_beam) ground = to_mm(pose_in_submap().z_m);
  const ScanEffect effect = integrator_.integrate(open_->surface, beams, ground, &reference_);
  evidence_.touch(EvidenceLayer::surface, effect.changed);
  beams_ += effect.beams;

  std::vector<CellIndex> seen_through;
  for (const Contradiction& contradiction : effect.contradictions) {
    const Cell before = open_->seen_through.cell(contradiction.cell);
    const auto emptiness = static_cast<std::uint8_t>(255 - config_.sensor_model.miss_probability);
    Cell after{contradiction.beam_height_mm, emptiness};
    if (before.known()) {
      after.height_mm = std::min(before.height_mm, contradiction.beam_height_mm);
      after.probability =
          std::min(combine(before.probability, emptiness), config_.sensor_model.max_probability);
    }
    if (after == before || !open_->seen_through.set(contradiction.cell, after)) continue;
    seen_through.push_back(contradiction.cell);
  }
  evidence_.touch(EvidenceLayer::seen_through, seen_through);
}

Pose Mapper::pose_in_submap() const {
  Pose T_submap_robot = pose();  // Submaps begin unturned, so only the origin moves.
  T_submap_robot.x_m -= open_->T_site_submap.x_mm / 1000.0;
  T_submap_robot.y_m -= open_->T_site_submap.y_mm / 1000.0;
  T_submap_robot.z_m -= open_->T_site_submap.z_mm / 1000.0;
  return T_submap_robot;
}

void Mapper::begin_submap() {
  // The origin is a corner of the site's tiles and a whole metre of height: as long as nothing
  // moves the submap it folds into the long-term map cell by cell.
  const int tile_mm = config_.cell_size_mm * Tile::kSize;
  SubmapPose T_site_submap;
  T_site_submap.x_mm =
      static_cast<std::int32_t>(std::floor(pose().x_m * 1000.0 / tile_mm)) * tile_mm;
  T_site_submap.y_mm =
      static_cast<std::int32_t>(std::floor(pose().y_m * 1000.0 / tile_mm)) * tile_mm;
  T_site_submap.z_mm = static_cast<std::int32_t>(std::lround(pose().z_m)) * 1000;
  open_ = &evidence_.begin(boot_, T_site_submap, config_.cell_size_mm);
  submap_begin_m_ = dead_reckoning_.distance_m();
  submap_turned_rad_ = 0.0;
  last_touch_.reset();
  make_reference();
}

void Mapper::make_reference() {
  reference_ = HeightMap(config_.cell_size_mm);
  const int tile_mm = config_.cell_size_mm * Tile::kSize;
  const std::int32_t dx = open_->T_site_submap.x_mm / tile_mm;
  const std::int32_t dy = open_->T_site_submap.y_mm / tile_mm;
  const std::int32_t dz = open_->T_site_submap.z_mm;
  const double reach_m = config_.mapping_range_m + config_.submap_distance_m;
  const auto reach = static_cast<std::int32_t>(std::ceil(reach_m * 1000.0 / tile_mm)) + 1;
  for (const auto& [key, tile] : site_map_.tiles()) {
    if (std::abs(key.tx - dx) > reach || std::abs(key.ty - dy) > reach) continue;
    Tile shifted(tile->datum_mm() - dz);
    for (int i = 0; i < Tile::kCells; ++i) {
      if (tile->known(i)) shifted.set(i, {tile->height_mm(i) - dz, tile->probability(i)});
    }
    reference_.insert({key.level, key.tx - dx, key.ty - dy}, shifted);
  }
}

void Mapper::close_submap() {
  fold(site_map_, *open_, config_.sensor_model);
  evidence_.close();
  open_ = nullptr;
  forget_far_tiles();
}

void Mapper::finish() {
  if (open_ != nullptr) close_submap();
}

void Mapper::forget_far_tiles() {
  const double tile_m = config_.cell_size_mm * Tile::kSize / 1000.0;
  std::vector<TileKey> far;
  for (const auto& [key, tile] : site_map_.tiles()) {
    const double dx_m = (key.tx + 0.5) * tile_m - pose().x_m;
    const double dy_m = (key.ty + 0.5) * tile_m - pose().y_m;
    if (std::hypot(dx_m, dy_m) > kKeepRadiusM) far.push_back(key);
  }
  for (const TileKey& key : far) site_map_.erase(key);
}

void Mapper::hit_ground(double x_m, double y_m, double z_m, std::vector<CellIndex>& changed) {
  const CellIndex index = open_->surface.cell_at(x_m, y_m);
  const Cell before = open_->surface.cell(index);
  const Cell after = rules_.after_hit(before, to_mm(z_m));
  if (after != before && open_->surface.set(index, after)) changed.push_back(index);
}

void Mapper::touch_ground() {
  const CellIndex here = site_map_.cell_at(pose().x_m, pose().y_m);
  if (last_touch_ == here) return;
  last_touch_ = here;
  const Eigen::Isometry3d T_submap_robot = to_transform(pose_in_submap());
  std::vector<CellIndex> changed;
  std::vector<CellIndex> emptied;
  const double step_m = site_map_.cell_size_m() * 0.9;
  for (double y_m = -config_.wheel_y_m; y_m <= config_.wheel_y_m; y_m += step_m) {
    for (double x_m = -config_.wheel_x_m; x_m <= config_.wheel_x_m; x_m += step_m) {
      const Eigen::Vector3d p = T_submap_robot * Eigen::Vector3d(x_m, y_m, 0.0);
      stand_on(p, emptied);
      hit_ground(p.x(), p.y(), p.z(), changed);
    }
  }
  evidence_.touch(EvidenceLayer::surface, changed);
  evidence_.touch(EvidenceLayer::seen_through, emptied);
}

void Mapper::stand_on(const Eigen::Vector3d& p_submap_m, std::vector<CellIndex>& emptied) {
  const CellIndex cell = open_->surface.cell_at(p_submap_m.x(), p_submap_m.y());
  const std::int32_t ground_mm = to_mm(p_submap_m.z());
  if (rules_.passed_below(open_->surface.cell(cell), ground_mm)) {
    open_->surface.set(cell, {});  // Whatever was seen there, the robot stands there now.
  }
  const Cell certain{ground_mm, kCertainlyEmpty};
  if (!rules_.passed_below(reference_.cell(cell), ground_mm)) return;
  if (open_->seen_through.cell(cell).probability == kCertainlyEmpty) return;
  if (open_->seen_through.set(cell, certain)) emptied.push_back(cell);
}

void Mapper::lay_apron(const Scan& scan, const LaserSpec& laser) {
  apron_laid_ = true;
  const Eigen::Isometry3d T_submap_robot = to_transform(pose_in_submap());
  const double step_m = site_map_.cell_size_m() * 0.5;
  std::vector<CellIndex> changed;
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
    const double bearing_rad = laser.first_angle_rad + static_cast<double>(i) * laser.step_rad;
    const double reach_m = std::min<double>(scan.range_m[i] - 2.0 * step_m, config_.start_apron_m);
    for (double r_m = 0.0; r_m < reach_m; r_m += step_m) {
      const Eigen::Vector3d p =
          T_submap_robot * Eigen::Vector3d(laser.T_robot_sensor.x_m + r_m * std::cos(bearing_rad),
                                           r_m * std::sin(bearing_rad), 0.0);
      const CellIndex index = open_->surface.cell_at(p.x(), p.y());
      if (!open_->surface.cell(index).known()) hit_ground(p.x(), p.y(), p.z(), changed);
    }
  }
  evidence_.touch(EvidenceLayer::surface, changed);
}

double Mapper::position_sigma_m() const {
  const Eigen::Matrix4d& covariance = dead_reckoning_.covariance();
  return std::sqrt(covariance(0, 0) + covariance(1, 1) + covariance(2, 2));
}

Cell Mapper::cell(CellIndex site_cell) const {
  if (open_ != nullptr) {
    const CellIndex shifted{site_cell.x - open_->T_site_submap.x_mm / config_.cell_size_mm,
                            site_cell.y - open_->T_site_submap.y_mm / config_.cell_size_mm};
    Cell found = open_->surface.cell(shifted);
    if (found.known()) {
      found.height_mm += open_->T_site_submap.z_mm;
      const Cell before = site_map_.cell(site_cell);  // As in a fold, the higher surface wins,
      const bool seen_through = open_->seen_through.cell(shifted).known();  // unless seen through.
      return !seen_through && rules_.passed_below(before, found.height_mm) ? before : found;
    }
  }
  return site_map_.cell(site_cell);
}

}  // namespace cairn::agent
