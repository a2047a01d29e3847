#include "robot_agent/pipeline/mapper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/common/angle.h"
#include "robot_agent/pipeline/submap_frame.h"

namespace cairn::agent {

namespace {

/// [1/255] Two beams below a surface, or four that grazed it.
constexpr std::uint8_t kSeenThrough = 180;

/// [submaps] A robot that turns on the spot for hours makes no way, but many submaps.
constexpr std::size_t kMaxYoung = 64;
/// [m] Around the robot is what lies within.
constexpr double kAroundM = 8.0;
/// [rad] A laser mounted so is level.
constexpr double kLevelMountRad = 0.01;
/// [rad] A correction that turns the robot by more ends the submap.
constexpr double kTurnThatTearsRad = 0.0087;
/// [m/m], [rad] So far a map is believed to be straight between two of its places.
constexpr double kMapBend = 0.01;

double horizontal_sigma_m(const Eigen::Matrix4d& covariance) {
  return std::sqrt(covariance(0, 0) + covariance(1, 1));
}

std::uint16_t saturated(double value) {
  return static_cast<std::uint16_t>(std::clamp(std::ceil(value), 1.0, 65'535.0));
}

}  // namespace

Mapper::Mapper(const MapperConfig& config, std::vector<LaserSpec> lasers, const Pose& T_site_start,
               std::uint64_t boot, proto::EvidenceSender& evidence)
    : config_(config),
      lasers_(std::move(lasers)),
      dead_reckoning_(config.dead_reckoning, T_site_start),
      T_site_robot_(T_site_start),
      since_correction_(config.dead_reckoning),
      since_submap_(config.dead_reckoning),
      since_previous_(config.dead_reckoning),
      since_whole_(config.dead_reckoning),
      incline_trust_(config.incline),
      ground_tracking_(config.ground_tracking),
      tracking_(config.tracking),
      writer_(config, boot, evidence),
      replica_(config.cell_size_mm, config.sensor_model, config.kept_bytes),
      localization_(config),
      relocalization_(config) {
  relocalization_.begin(T_site_start);
}

// ---- Readings -----------------------------------------------------------------------------------

void Mapper::take_motion(const MotionReading& reading) {
  const Pose before = dead_reckoning_.pose();
  const double way_before_m = distance_m();
  if (!dead_reckoning_.update(reading)) return;
  const double dt_s = to_seconds(reading.stamp - std::exchange(last_motion_, reading.stamp));
  incline_trust_.note(before, dead_reckoning_.pose(), reading.stamp);
  ground_tracking_.move(distance_m() - way_before_m,
                        incline_trust_.rate_rad_s() * std::max(dt_s, 0.0),
                        incline_trust_.sigma_rad());
  for (Drift* drift : {&since_correction_, &since_submap_, &since_previous_, &since_whole_}) {
    drift->add(before, dead_reckoning_.pose(), std::max(dt_s, 0.0));
  }
  const double turned_rad = wrap_angle(dead_reckoning_.pose().yaw_rad - before.yaw_rad);
  submap_turned_rad_ += std::abs(turned_rad);
  gyro_check_.move(turned_rad, std::max(dt_s, 0.0));
  if (gyro_check_.due()) gyro_check_.conclude(dead_reckoning_);
  place_robot();
  turn_submaps_over();
  if (writer_.open() != nullptr) writer_.touch_ground(T_site_robot_);
  if (!config_.localize) return;
  localization_.move(T_site_robot_);
  relocalization_.move(dead_reckoning_.pose());
  localize();
}

void Mapper::take_scan(const Scan& scan) {
  if (scan.laser >= lasers_.size()) return;
  const LaserSpec& laser = lasers_[scan.laser];
  if (config_.localize && in_section(laser)) track(scan, laser);
  turn_submaps_over();
  const Stance stance = stand_on_ground(scan, laser);
  const double range_m = trusted_range_m(laser, stance.incline_sigma_rad);
  if (writer_.open() != nullptr) writer_.take_scan(scan, laser, stance.T_site_robot, range_m);
  if (!config_.localize) return;
  if (localization() == LocalizationState::lost) {
    relocalization_.take_scan(scan, laser, range_m);
  } else {
    localization_.take_scan(scan, laser, stance.T_site_robot, stance.incline_sigma_rad);
  }
  localize();
}

void Mapper::finish() {
  if (writer_.open() != nullptr) close_submap();
}

void Mapper::place_robot() { T_site_robot_ = compose(T_site_local_, dead_reckoning_.pose()); }

bool Mapper::in_section(const LaserSpec& laser) {
  const Pose& mount = laser.T_robot_sensor;
  if (std::abs(mount.roll_rad) > kLevelMountRad || std::abs(mount.pitch_rad) > kLevelMountRad) {
    return false;
  }
  const Pose& robot = dead_reckoning_.pose();
  const double roll_rad = robot.roll_rad + missed_incline_rad_.x();
  const double pitch_rad = robot.pitch_rad + missed_incline_rad_.y();
  const bool level =
      std::hypot(roll_rad, pitch_rad) < config_.section_tilt_rad && !ground_tracking_.in_doubt();
  if (level && section_z_m_ && std::abs(robot.z_m - *section_z_m_) < config_.section_z_m) {
    return true;
  }
  leave_section();
  if (level) section_z_m_ = robot.z_m;
  return level;
}

void Mapper::leave_section() {
  tracking_.forget();
  gyro_check_.interrupt();
  section_z_m_.reset();
}

void Mapper::track(const Scan& scan, const LaserSpec& laser) {
  constexpr std::array kPlanar{0, 1, 3};
  const Eigen::Matrix3d moved = dead_reckoning_.covariance()(kPlanar, kPlanar);
  const TrackedStep step = tracking_.track(scan, laser, dead_reckoning_.pose(), moved);
  if (!step.matched) return;
  const double turn_rad = wrap_angle(step.T_local_robot.yaw_rad - dead_reckoning_.pose().yaw_rad);
  // In a plane world there are no slopes; its logs may have no gyro either.
  const bool believed = gyro_check_.believes(turn_rad, dead_reckoning_.gyro());
  if (!laser.ground_along_beam && !believed) return leave_section();
  gyro_check_.corrected(turn_rad);
  dead_reckoning_.correct(step.T_local_robot, Eigen::Matrix4d::Zero());
  for (Drift* drift : {&since_correction_, &since_submap_, &since_previous_, &since_whole_}) {
    drift->track(step.T_local_robot, step.information, step.kept);
  }
  submap_turned_rad_ += std::abs(turn_rad);
  place_robot();
  localization_.move(T_site_robot_);
}

double Mapper::incline_sigma_rad(const LaserSpec& laser) const {
  return laser.ground_along_beam ? 0.0 : incline_trust_.sigma_rad();
}

double Mapper::trusted_range_m(const LaserSpec& laser, double incline_sigma_rad) const {
  if (laser.ground_along_beam) return config_.mapping_range_m;  // A plane world has no incline.
  return std::min(config_.mapping_range_m, incline_trust_.range_m(incline_sigma_rad));
}

Mapper::Stance Mapper::stand_on_ground(const Scan& scan, const LaserSpec& laser) {
  Stance stance{T_site_robot_, incline_sigma_rad(laser)};
  const bool placed = config_.localize && localization() != LocalizationState::lost;
  if (!placed || laser.ground_along_beam) return stance;
  const auto off =
      ground_tracking_.lay(scan, laser, T_site_robot_, replica_.old(), stance.incline_sigma_rad);
  missed_incline_rad_ =
      off ? Eigen::Vector2d(off->roll_rad, off->pitch_rad) : Eigen::Vector2d(0, 0);
  if (!off) return stance;
  T_site_local_.z_m += off->z_m;
  place_robot();
  stance = {T_site_robot_, off->incline_sigma_rad};
  stance.T_site_robot.roll_rad += off->roll_rad;
  stance.T_site_robot.pitch_rad += off->pitch_rad;
  return stance;
}

// ---- Submaps ------------------------------------------------------------------------------------

void Mapper::turn_submaps_over() {
  if (writer_.open() != nullptr && submap_full()) close_submap();
  if (writer_.open() == nullptr && localization() != LocalizationState::lost) begin_submap();
}

bool Mapper::submap_full() const {
  return distance_m() - young_.back().begun_m > config_.submap_distance_m ||
         submap_turned_rad_ > config_.submap_turn_rad;
}

void Mapper::begin_submap() {
  writer_.begin(T_site_robot_, replica_.now(), telling());
  const Pose T_site_submap = pose_of(writer_.open()->T_site_submap);
  young_.push_back(
      {writer_.open()->id.sequence, from_to(level(T_site_local_), T_site_submap), distance_m()});
  was_chained_ = std::exchange(chained_, true);
  if (was_chained_) link_submap();
  since_submap_.start(Eigen::Matrix4d::Zero());
  submap_turned_rad_ = 0.0;
  age_submaps();
}

/// On ground that it knows well a robot tells only what is new there. But the pose graph lays old
/// and new ground over each other by what both show: so where the robot comes back to ground of its
/// own, and now and then as it becomes less sure since, it tells all.
SubmapWriter::Telling Mapper::telling() {
  const SiteLocalization::Surroundings around = surroundings();
  if (localization() != LocalizationState::localized || around.old_share < config_.known_share) {
    whole_ = 0;
    return SubmapWriter::Telling::all;
  }
  const double drift_m = horizontal_sigma_m(since_whole_.covariance());
  if (around.given ? position_sigma_m() < config_.firm_sigma_m
                   : whole_ >= config_.whole_submaps && drift_m < config_.firm_sigma_m) {
    return SubmapWriter::Telling::news;
  }
  ++whole_;
  since_whole_.start(Eigen::Matrix4d::Zero());
  return SubmapWriter::Telling::all;
}

void Mapper::link_submap() {
  const SubmapLink by_way = way_link();
  const std::optional<SubmapLink> by_map = map_link();
  writer_.link(by_map && by_map->sigma_xy_mm < by_way.sigma_xy_mm ? *by_map : by_way);
}

SubmapLink Mapper::way_link() const {
  const Pose& T_local_previous = young_[young_.size() - 2].T_local_submap;
  const Pose& T_local_submap = young_.back().T_local_submap;
  // What is known is where the robot is; the submap's origin lies off it by a lever.
  const Pose& robot = dead_reckoning_.pose();
  const Eigen::Matrix4d& covariance = since_previous_.covariance();
  const double lever_m = std::hypot(T_local_submap.x_m - robot.x_m, T_local_submap.y_m - robot.y_m);
  const double xy_m2 =
      0.5 * (covariance(0, 0) + covariance(1, 1)) + 0.5 * lever_m * lever_m * covariance(3, 3);
  return {.T_previous_submap = rounded(from_to(T_local_previous, T_local_submap)),
          .sigma_xy_mm = saturated(std::sqrt(xy_m2) * 1e3),
          .sigma_z_mm = saturated(std::sqrt(covariance(2, 2)) * 1e3),
          .sigma_yaw_1e4rad = saturated(std::sqrt(covariance(3, 3)) * 1e4)};
}

/// Between two places on a map that the robot was given and fits: what drifted on the way there,
/// over known ground, says less than the map.
std::optional<SubmapLink> Mapper::map_link() const {
  if (localization() != LocalizationState::localized || !surroundings().given) return std::nullopt;
  const Submap* const previous = replica_.find(young_[young_.size() - 2].sequence);
  if (previous == nullptr) return std::nullopt;
  const Pose T_previous_submap =
      from_to(pose_of(previous->T_site_submap), pose_of(writer_.open()->T_site_submap));
  const double apart_m = std::hypot(T_previous_submap.x_m, T_previous_submap.y_m);
  const double sigma_m = std::numbers::sqrt2 * position_sigma_m() + kMapBend * apart_m;
  return SubmapLink{.T_previous_submap = rounded(T_previous_submap),
                    .sigma_xy_mm = saturated(sigma_m * 1e3),
                    .sigma_z_mm = saturated(sigma_m * 1e3),
                    .sigma_yaw_1e4rad = saturated(kMapBend * 1e4)};
}

void Mapper::close_submap() {
  if (auto closed = writer_.close()) {
    replica_.add(*std::move(closed));
    since_previous_ = since_submap_;
  } else {  // Nothing was to be told: the next one takes its place in the chain.
    young_.pop_back();
    chained_ = was_chained_;
  }
  forget_far_tiles();
}

void Mapper::forget_far_tiles() {
  if (localization() == LocalizationState::lost) return;  // Who knows what is far?
  replica_.forget_beyond(T_site_robot_.x_m, T_site_robot_.y_m, kKeepRadiusM);
}

void Mapper::age_submaps() {
  // A submap was written until the next one began; the last is open.
  std::size_t old = 0;
  while (young_.size() - old > 2 && (distance_m() - young_[old + 1].begun_m > config_.old_after_m ||
                                     young_.size() - old > kMaxYoung)) {
    ++old;
  }
  if (old == 0) return;
  replica_.age(young_[old - 1].sequence);
  young_.erase(young_.begin(), young_.begin() + static_cast<std::ptrdiff_t>(old));
}

// ---- Localization -------------------------------------------------------------------------------

void Mapper::localize() {
  if (localization() == LocalizationState::lost) return search_site();
  if (!localization_.due()) return;
  const Eigen::Matrix4d covariance = turned(since_correction_.covariance(), T_site_local_.yaw_rad);
  const auto answer =
      localization_.localize(replica_.old(), surroundings(), T_site_robot_, covariance);
  if (answer) correct(answer->T_site_robot, answer->covariance);
  if (localization() == LocalizationState::lost) become_lost();
}

void Mapper::become_lost() {
  if (writer_.open() != nullptr) close_submap();
  chained_ = false;  // Nobody knows how it came here.
  relocalization_.begin(dead_reckoning_.pose());
  relocalization_.map_changed();
}

void Mapper::search_site() {
  // In the old part: what the robot made while it erred without knowing lies at a wrong place.
  const auto match = relocalization_.find(replica_.old());
  if (!match) return;
  localization_.take(*match);
  if (match->accepted) correct(match->T_site_robot, match->covariance);
}

SiteLocalization::Surroundings Mapper::surroundings() const {
  const int reach = static_cast<int>(kAroundM * 1000.0 / config_.cell_size_mm);
  const CellIndex here = replica_.now().cell_at(T_site_robot_.x_m, T_site_robot_.y_m);
  const int stride = std::max(1, reach / 32);
  int known = 0;
  int old = 0;
  for (int y = -reach; y <= reach; y += stride) {
    for (int x = -reach; x <= reach; x += stride) {
      const CellIndex at{here.x + x, here.y + y};
      if (!cell(at).known()) continue;
      ++known;
      if (replica_.old().cell(at).known()) ++old;
    }
  }
  return {.old_share = known == 0 ? 0.0 : static_cast<double>(old) / known,
          .given = replica_.given_at(T_site_robot_.x_m, T_site_robot_.y_m)};
}

void Mapper::correct(const Pose& T_site_robot, const Eigen::Matrix4d& covariance) {
  since_correction_.start(turned(covariance, -T_site_local_.yaw_rad));
  ground_tracking_.restart(std::sqrt(covariance(2, 2)));
  put(T_site_robot);
}

void Mapper::put(const Pose& T_site_robot) {
  const double way_m =
      std::hypot(T_site_robot.x_m - T_site_robot_.x_m, T_site_robot.y_m - T_site_robot_.y_m,
                 T_site_robot.z_m - T_site_robot_.z_m);
  const double turn_rad = std::abs(wrap_angle(T_site_robot.yaw_rad - T_site_robot_.yaw_rad));
  // Within a cell the open submap takes it; beyond, it would hold the same wall twice.
  const bool tears = way_m * 1000.0 > config_.cell_size_mm || turn_rad > kTurnThatTearsRad;
  if (tears && writer_.open() != nullptr) close_submap();
  T_site_local_ = compose(level(T_site_robot), from_to(level(dead_reckoning_.pose()), {}));
  place_robot();
}

double Mapper::position_sigma_m() const {
  const Eigen::Matrix4d& covariance = since_correction_.covariance();
  return std::sqrt(covariance(0, 0) + covariance(1, 1) + covariance(2, 2));
}

// ---- What the server says -----------------------------------------------------------------------

void Mapper::take_tiles(const std::vector<GivenTile>& tiles) {
  replica_.take(tiles);
  relocalization_.map_changed();
  forget_far_tiles();
}

void Mapper::move_submaps(const std::vector<std::pair<std::uint32_t, SubmapPose>>& poses) {
  const auto newest = std::max_element(
      poses.begin(), poses.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (newest == poses.end()) return;
  const Submap* const before = replica_.find(newest->first);
  if (before == nullptr) return replica_.move(poses);
  const Pose T_new_old =
      compose(pose_of(newest->second), from_to(pose_of(before->T_site_submap), {}));
  const Pose T_site_robot = compose(T_new_old, T_site_robot_);
  auto all = poses;
  put(T_site_robot);  // Closes the open submap if need be: then it is one of the later ones.
  for (auto& [sequence, pose] : replica_.placed_after(newest->first)) {
    all.emplace_back(sequence, rounded(compose(T_new_old, pose_of(pose))));
  }
  replica_.move(all);
  relocalization_.map_changed();
  localization_.carry(T_site_robot_);
  turn_submaps_over();
}

Cell Mapper::cell(CellIndex site_cell) const {
  const Cell before = replica_.now().cell(site_cell);
  const Submap* const open = writer_.open();
  if (open == nullptr) return before;
  const CellIndex shifted{site_cell.x - open->T_site_submap.x_mm / config_.cell_size_mm,
                          site_cell.y - open->T_site_submap.y_mm / config_.cell_size_mm};
  Cell found = open->surface.cell(shifted);
  if (!found.known()) return before;
  found.height_mm += open->T_site_submap.z_mm;
  // As in a fold, the higher surface wins, unless it was seen through.
  const bool higher = before.known() && std::int64_t{before.height_mm} - found.height_mm >
                                            config_.sensor_model.tolerance_mm;
  return higher && open->seen_through.cell(shifted).probability < kSeenThrough ? before : found;
}

}  // namespace cairn::agent
