#include "robot_agent/pipeline/submap_writer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/common/angle.h"
#include "robot_agent/pipeline/submap_frame.h"

namespace cairn::agent {
namespace {

/// A robot that stays within this stands still: its estimated pose wanders meanwhile.
constexpr double kStandsWithinM = 0.15;
constexpr double kStandsWithinRad = 0.1;

}  // namespace

SubmapWriter::SubmapWriter(const MapperConfig& config, std::uint64_t boot,
                           proto::EvidenceSender& evidence)
    : config_(config),
      boot_(boot),
      evidence_(evidence),
      integrator_(config.sensor_model),
      rules_(config.sensor_model),
      news_(config.news, config.sensor_model),
      reference_(config.cell_size_mm),
      surface_(config.cell_size_mm),
      seen_through_(config.cell_size_mm) {
  evidence_.set_coarseness(config.coarseness);
}

void SubmapWriter::begin(const Pose& T_site_robot, const HeightMap& replica, Telling telling) {
  telling_ = telling;
  told_ = false;
  // The origin is a corner of the site's tiles and a whole metre of height: as long as nothing
  // moves the submap it folds into the long-term map cell by cell.
  const int tile_mm = config_.cell_size_mm * Tile::kSize;
  const auto corner_mm = [tile_mm](double m) {
    return static_cast<std::int32_t>(std::floor(m * 1000.0 / tile_mm)) * tile_mm;
  };
  const SubmapPose T_site_submap{corner_mm(T_site_robot.x_m), corner_mm(T_site_robot.y_m),
                                 static_cast<std::int32_t>(std::lround(T_site_robot.z_m)) * 1000,
                                 0};
  open_ = &evidence_.begin(boot_, T_site_submap, config_.cell_size_mm);
  surface_ = HeightMap(config_.cell_size_mm);
  seen_through_ = HeightMap(config_.cell_size_mm);
  last_touch_.reset();
  make_reference(replica);
}

void SubmapWriter::make_reference(const HeightMap& replica) {
  reference_ = HeightMap(config_.cell_size_mm);
  const int tile_mm = config_.cell_size_mm * Tile::kSize;
  const std::int32_t dx = open_->T_site_submap.x_mm / tile_mm;
  const std::int32_t dy = open_->T_site_submap.y_mm / tile_mm;
  const std::int32_t dz = open_->T_site_submap.z_mm;
  const double reach_m = config_.mapping_range_m + config_.submap_distance_m;
  const auto reach = static_cast<std::int32_t>(std::ceil(reach_m * 1000.0 / tile_mm)) + 1;
  for (const auto& [key, tile] : replica.tiles()) {
    if (std::abs(key.tx - dx) > reach || std::abs(key.ty - dy) > reach) continue;
    Tile shifted(tile->datum_mm() - dz);
    for (int i = 0; i < Tile::kCells; ++i) {
      if (tile->known(i)) shifted.set(i, {tile->height_mm(i) - dz, tile->probability(i)});
    }
    reference_.insert({key.level, key.tx - dx, key.ty - dy}, shifted);
  }
}

std::optional<Submap> SubmapWriter::close() {
  assert(open_ != nullptr);
  tell_noted();
  tell_patient();
  if (!told_) {
    open_ = nullptr;
    evidence_.discard();
    return std::nullopt;
  }
  Submap closed = *open_;
  closed.closed = true;
  open_ = nullptr;
  evidence_.close();
  return closed;
}

Pose SubmapWriter::in_submap(const Pose& T_site_robot) const {
  Pose T_submap_robot = T_site_robot;  // Submaps begin unturned, so only the origin moves.
  T_submap_robot.x_m -= open_->T_site_submap.x_mm / 1000.0;
  T_submap_robot.y_m -= open_->T_site_submap.y_mm / 1000.0;
  T_submap_robot.z_m -= open_->T_site_submap.z_mm / 1000.0;
  return T_submap_robot;
}

void SubmapWriter::take_scan(const Scan& scan, const LaserSpec& laser, const Pose& T_site_robot,
                             double range_m) {
  const Pose T_submap_robot = in_submap(T_site_robot);
  const std::vector<Beam> beams =
      shortened(beams_in_site(scan, laser, T_submap_robot, range_m), range_m);
  std::optional<std::int32_t> ground_mm;
  if (laser.ground_along_beam) ground_mm = to_mm(T_submap_robot.z_m);
  integrate(beams, ground_mm);
  if (!apron_laid_ && !laser.ground_along_beam && scan.laser == 0) {
    lay_apron(scan, laser, T_submap_robot);
  }
  tell_when_due(T_site_robot, scan.stamp);
}

void SubmapWriter::integrate(const std::vector<Beam>& beams,
                             std::optional<std::int32_t> ground_mm) {
  const ScanEffect effect = integrator_.integrate(surface_, beams, ground_mm, &reference_);
  note(effect.changed);
  beams_ += effect.beams;
  note_seen_through(effect.contradictions);
}

void SubmapWriter::note_seen_through(const std::vector<Contradiction>& contradictions) {
  const SensorModel& model = config_.sensor_model;
  std::vector<CellIndex> seen_through;
  for (const Contradiction& contradiction : contradictions) {
    const auto emptiness = static_cast<std::uint8_t>(
        255 - (contradiction.grazing ? model.graze_probability : model.miss_probability));
    const Cell before = seen_through_.cell(contradiction.cell);
    Cell after{contradiction.height_mm, emptiness};
    if (before.known()) {
      after.height_mm = std::min(before.height_mm, contradiction.height_mm);
      after.probability = std::min(combine(before.probability, emptiness), model.max_probability);
    }
    if (after == before || !seen_through_.set(contradiction.cell, after)) continue;
    seen_through.push_back(contradiction.cell);
  }
  note(seen_through);
}

void SubmapWriter::note(const std::vector<CellIndex>& changed) {
  noted_.insert(noted_.end(), changed.begin(), changed.end());
}

void SubmapWriter::tell_when_due(const Pose& T_site_robot, MonotonicTime now) {
  const Pose T_submap = in_submap(T_site_robot);
  evidence_.set_view(
      {surface_.cell_at(T_submap.x_m, T_submap.y_m), proto::heading_of(T_submap.yaw_rad)});
  const double way_m =
      std::hypot(T_site_robot.x_m - stood_at_.x_m, T_site_robot.y_m - stood_at_.y_m);
  const double turn_rad = std::abs(wrap_angle(T_site_robot.yaw_rad - stood_at_.yaw_rad));
  if (way_m > kStandsWithinM || turn_rad > kStandsWithinRad) {
    stood_at_ = T_site_robot;
    stood_since_ = now;
  }
  parked_ = to_seconds(now - stood_since_) > config_.parked_telling_s;
  if (parked_ && to_seconds(now - told_at_) < config_.parked_telling_s) return;
  tell_noted();
  told_at_ = now;
  if (to_seconds(now - told_patient_at_) < config_.news.patience_s) return;
  tell_patient();
  told_patient_at_ = now;
}

void SubmapWriter::tell_noted() {
  std::vector<CellIndex> now;
  for (const CellIndex cell : std::exchange(noted_, {})) {
    const News::Worth worth = worth_of(cell);
    if (worth == News::Worth::much) now.push_back(cell);
    if (worth == News::Worth::little) patient_.push_back(cell);
  }
  tell(now);
}

void SubmapWriter::tell_patient() {
  std::ranges::sort(patient_, std::less<>{},
                    [](CellIndex cell) { return std::pair(cell.y, cell.x); });
  patient_.erase(std::unique(patient_.begin(), patient_.end()), patient_.end());
  std::erase_if(patient_,
                [this](CellIndex cell) { return worth_of(cell) == News::Worth::nothing; });
  tell(std::exchange(patient_, {}));
}

/// What the evidence makes of the long-term map, against what the evidence told so far makes of it.
/// Where the map knows nothing, all of it is.
News::Worth SubmapWriter::worth_of(CellIndex cell) const {
  if (telling_ == Telling::all) return News::Worth::much;
  const Cell known = reference_.cell(cell);
  const Cell seen_told = open_->seen_through.cell(cell);
  const Cell surface_told = open_->surface.cell(cell);
  const bool told = seen_told.known() || surface_told.known();
  if (told && !known.known()) return News::Worth::little;
  const Cell before = news_.folded(known, seen_told, surface_told);
  const Cell surface = surface_.cell(cell);
  const Cell after = news_.folded(known, seen_through_.cell(cell), surface);
  const News::Worth worth = news_.worth(before, after, surface, ground_beside_mm(cell, after));
  if (worth == News::Worth::nothing || told) return worth;
  return is_of_its_edge(cell) ? News::Worth::nothing : worth;
}

/// [mm] The lowest the map knows within two cells; `own` where it knows nothing.
std::int32_t SubmapWriter::ground_beside_mm(CellIndex cell, const Cell& own) const {
  constexpr int kBeside = 2;
  std::int32_t lowest_mm = own.height_mm;
  for (int dy = -kBeside; dy <= kBeside; ++dy) {
    for (int dx = -kBeside; dx <= kBeside; ++dx) {
      const Cell beside = reference_.cell({cell.x + dx, cell.y + dy});
      if (beside.known()) lowest_mm = std::min(lowest_mm, beside.height_mm);
    }
  }
  return lowest_mm;
}

/// Whether what the robot sees there is what it knows right beside: where it is, and where a cell
/// ends, is never known so well that the edges of things lay in the same cells each time. A surface
/// counts as gone only where nothing beside it shows that it still stands.
bool SubmapWriter::is_of_its_edge(CellIndex cell) const {
  const Cell known = reference_.cell(cell);
  if (!known.known() || seen_through_.cell(cell).probability == kCertainlyEmpty) return false;
  const auto same = [this](const Cell& a, const Cell& b) {
    return a.known() && b.known() &&
           std::abs(a.height_mm - b.height_mm) <= config_.sensor_model.tolerance_mm;
  };
  const Cell surface = surface_.cell(cell);
  const bool higher =
      surface.known() && surface.height_mm > known.height_mm && !same(surface, known);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const CellIndex beside{cell.x + dx, cell.y + dy};
      if (beside == cell) continue;
      const Cell known_beside = reference_.cell(beside);
      if (higher ? same(known_beside, surface)
                 : same(known_beside, known) && same(surface_.cell(beside), known_beside)) {
        return true;
      }
    }
  }
  return false;
}

/// Both layers of each cell: doubt without what speaks against it would unlearn what still stands.
void SubmapWriter::tell(const std::vector<CellIndex>& cells) {
  for (const auto layer : {EvidenceLayer::surface, EvidenceLayer::seen_through}) {
    tell(layer, cells);
  }
}

void SubmapWriter::tell(EvidenceLayer layer, const std::vector<CellIndex>& cells) {
  const HeightMap& exact = layer == EvidenceLayer::surface ? surface_ : seen_through_;
  HeightMap& told = layer_of(*open_, layer);
  std::vector<CellIndex> news;
  for (const CellIndex cell : cells) {
    const Cell before = told.cell(cell);
    const Cell now = coarse(exact.cell(cell), before, config_.coarseness);
    const bool same = now == before || (!now.known() && !before.known());
    if (!same && told.set(cell, now)) news.push_back(cell);
  }
  told_ = told_ || !news.empty();
  evidence_.touch(layer, news);
}

void SubmapWriter::touch_ground(const Pose& T_site_robot) {
  const Pose T_submap = in_submap(T_site_robot);
  const CellIndex here = surface_.cell_at(T_submap.x_m, T_submap.y_m);
  if (last_touch_ == here) return;
  last_touch_ = here;
  const Eigen::Isometry3d T_submap_robot = to_transform(T_submap);
  std::vector<CellIndex> changed;
  std::vector<CellIndex> emptied;
  const double step_m = surface_.cell_size_m() * 0.9;
  for (double y_m = -config_.wheel_y_m; y_m <= config_.wheel_y_m; y_m += step_m) {
    for (double x_m = -config_.wheel_x_m; x_m <= config_.wheel_x_m; x_m += step_m) {
      const Eigen::Vector3d p = T_submap_robot * Eigen::Vector3d(x_m, y_m, 0.0);
      stand_on(p, emptied);
      hit_ground(p.x(), p.y(), p.z(), changed);
    }
  }
  note(changed);
  note(emptied);
  if (!parked_) tell_noted();
}

void SubmapWriter::hit_ground(double x_m, double y_m, double z_m, std::vector<CellIndex>& changed) {
  const CellIndex index = surface_.cell_at(x_m, y_m);
  const Cell before = surface_.cell(index);
  const Cell after = rules_.after_hit(before, to_mm(z_m));
  if (after != before && surface_.set(index, after)) changed.push_back(index);
}

void SubmapWriter::stand_on(const Eigen::Vector3d& p_submap_m, std::vector<CellIndex>& emptied) {
  const CellIndex cell = surface_.cell_at(p_submap_m.x(), p_submap_m.y());
  const std::int32_t ground_mm = to_mm(p_submap_m.z());
  if (rules_.passed_below(surface_.cell(cell), ground_mm)) {
    surface_.set(cell, {});  // Whatever was seen there, the robot stands there now.
  }
  const Cell certain{ground_mm, kCertainlyEmpty};
  if (!rules_.passed_below(reference_.cell(cell), ground_mm)) return;
  if (seen_through_.cell(cell).probability == kCertainlyEmpty) return;
  if (seen_through_.set(cell, certain)) emptied.push_back(cell);
}

void SubmapWriter::lay_apron(const Scan& scan, const LaserSpec& laser, const Pose& T_submap) {
  apron_laid_ = true;
  const Eigen::Isometry3d T_submap_robot = to_transform(T_submap);
  const double step_m = surface_.cell_size_m() * 0.5;
  std::vector<CellIndex> changed;
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
    const double bearing_rad = laser.first_angle_rad + static_cast<double>(i) * laser.step_rad;
    const double reach_m = std::min<double>(scan.range_m[i] - 2.0 * step_m, config_.start_apron_m);
    for (double r_m = 0.0; r_m < reach_m; r_m += step_m) {
      const Eigen::Vector3d p =
          T_submap_robot * Eigen::Vector3d(laser.T_robot_sensor.x_m + r_m * std::cos(bearing_rad),
                                           r_m * std::sin(bearing_rad), 0.0);
      const CellIndex index = surface_.cell_at(p.x(), p.y());
      if (!surface_.cell(index).known()) hit_ground(p.x(), p.y(), p.z(), changed);
    }
  }
  note(changed);
}

}  // namespace cairn::agent
