#include "tests/bench/map_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>

#include "core/map/fold.h"
#include "core/map/update.h"
#include "robot_agent/input/dem_file.h"
#include "robot_agent/pipeline/submap_frame.h"

namespace cairn::bench {
namespace {

constexpr int kCellMm = 125;
/// As the agent has them (MapperConfig).
constexpr double kSubmapWayM = 8.0;
constexpr double kMappingRangeM = 15.0;
/// As imported cells have it.
constexpr std::uint8_t kTerrainProbability = 230;

/// Maps scans into one submap after the other.
class SubmapMaker {
 public:
  SubmapMaker(const DriveSetting& setting, bool moved)
      : setting_(setting), moved_(moved), random_(setting.seed), integrator_(SensorModel{}) {}

  void take(const Scan& scan, const LaserSpec& laser, const Pose& pose) {
    if (last_) way_m_ += std::hypot(pose.x_m - last_->x_m, pose.y_m - last_->y_m);
    last_ = pose;
    if (!told_ || way_m_ > kSubmapWayM) begin(pose);
    const Pose T_submap = agent::from_to(agent::pose_of(told_->T_site_submap), pose);
    const auto effect = integrator_.integrate(
        exact_, beams_in_site(scan, laser, T_submap, kMappingRangeM), std::nullopt, nullptr);
    for (const CellIndex at : effect.changed) {
      told_->surface.set(at, coarse(exact_.cell(at), told_->surface.cell(at), setting_.coarseness));
    }
  }
  /// The map of all that was taken.
  [[nodiscard]] const HeightMap& finish() {
    fold_in();
    return site_;
  }

 private:
  void begin(const Pose& pose) {
    fold_in();
    way_m_ = 0.0;
    exact_ = HeightMap(kCellMm);
    const auto corner_mm = [](double m) {
      constexpr int kTileMm = kCellMm * Tile::kSize;
      return static_cast<std::int32_t>(std::floor(m * 1000.0 / kTileMm)) * kTileMm;
    };
    const auto z_mm = static_cast<std::int32_t>(std::lround(pose.z_m)) * 1000;
    const SubmapPose place{corner_mm(pose.x_m), corner_mm(pose.y_m), z_mm, 0};
    told_.emplace(SubmapId{1, ++sequence_}, place, kCellMm);
  }
  void fold_in() {
    if (!told_) return;
    if (moved_) move(told_->T_site_submap);
    fold(site_, *told_, SensorModel{});
    told_.reset();
  }
  void move(SubmapPose& pose) {
    std::uniform_int_distribution<int> by_mm(-30, 30);
    std::uniform_int_distribution<int> by_1e4rad(-40, 40);
    pose.x_mm += by_mm(random_);
    pose.y_mm += by_mm(random_);
    pose.z_mm += by_mm(random_) / 2;
    pose.yaw_1e4rad += by_1e4rad(random_);
  }

  DriveSetting setting_;
  bool moved_;
  std::mt19937_64 random_;
  ScanIntegrator integrator_;
  HeightMap exact_{kCellMm};
  std::optional<Submap> told_;
  HeightMap site_{kCellMm};
  std::optional<Pose> last_;
  double way_m_ = 0.0;
  std::uint32_t sequence_ = 0;
};

MapTiles sorted_tiles(const HeightMap& map) {
  MapTiles tiles;
  for (const auto& [key, tile] : map.tiles()) {
    if (tile->known_count() > 0) tiles.emplace_back(key, *tile);
  }
  std::ranges::sort(tiles, {}, &MapTiles::value_type::first);
  return tiles;
}

}  // namespace

Result<MapTiles> tiles_of_drive(const DriveSetting& setting, bool moved) {
  SubmapMaker maker(setting, moved);
  const auto on_scan = [&](const Scan& scan, const LaserSpec& laser, const Pose& pose) {
    maker.take(scan, laser, pose);
  };
  const Status driven = drive_about(setting, {on_scan, [] {}});
  if (!driven) return driven.error();
  return sorted_tiles(maker.finish());
}

Result<MapTiles> tiles_of_terrain(const std::string& file) {
  const auto raster = agent::read_dem(file);
  if (!raster) return raster.error();
  HeightMap map(kCellMm);
  for (int y = 0; y < raster->rows(); ++y) {
    for (int x = 0; x < raster->columns(); ++x) {
      map.set({x, y}, {agent::to_mm(raster->at(x, y)), kTerrainProbability});
    }
  }
  return sorted_tiles(map);
}

}  // namespace cairn::bench
