#include "tests/bench/drive_deltas.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/delta/block.h"
#include "core/map/update.h"

namespace cairn::bench {
namespace {

/// Maps scans and tells the changes.
class Teller {
 public:
  Teller(const DriveSetting& setting, Drive& drive)
      : setting_(setting), drive_(drive), integrator_(SensorModel{}), submap_({1, 1}, {}, 125) {}

  void take(const Scan& scan, const LaserSpec& laser, const Pose& pose) {
    pose_ = pose;
    const auto effect = integrator_.integrate(
        drive_.exact, beams_in_site(scan, laser, pose, setting_.range_m), std::nullopt, nullptr);
    std::vector<CellIndex> told;
    for (const CellIndex at : effect.changed) {
      const Cell before = submap_.surface.cell(at);
      const Cell now = coarse(drive_.exact.cell(at), before, setting_.coarseness);
      const bool same = now == before || (!now.known() && !before.known());
      if (!same && submap_.surface.set(at, now)) told.push_back(at);
    }
    versions_.touch(EvidenceLayer::surface, told);
  }

  /// The blocks that changed since the last call.
  void tell() {
    Delta delta;
    for (const auto& [key, block] : versions_.blocks()) {
      std::uint32_t& last = told_[key];
      if (block.version == last) continue;
      delta.push_back({1, key, last, block.version, versions_.changes_since(key, last, submap_)});
      last = block.version;
      versions_.told(key);
    }
    if (delta.empty()) return;
    std::ranges::sort(delta, {}, &proto::BlockUpdate::key);
    drive_.deltas.push_back(std::move(delta));
    drive_.views.push_back(
        {submap_.surface.cell_at(pose_.x_m, pose_.y_m), proto::heading_of(pose_.yaw_rad)});
  }

  [[nodiscard]] const HeightMap& told() const { return submap_.surface; }

 private:
  DriveSetting setting_;
  Drive& drive_;
  ScanIntegrator integrator_;
  Submap submap_;
  Pose pose_;
  SubmapVersions versions_;
  std::unordered_map<BlockKey, std::uint32_t, BlockKeyHash> told_;  ///< Version told, by block.
};

}  // namespace

Result<Drive> drive_deltas(const DriveSetting& setting) {
  Drive drive;
  Teller teller(setting, drive);
  std::optional<Pose> last;
  const auto on_scan = [&](const Scan& scan, const LaserSpec& laser, const Pose& pose) {
    teller.take(scan, laser, pose);
    if (last) drive.way_m += std::hypot(pose.x_m - last->x_m, pose.y_m - last->y_m);
    last = pose;
  };
  const Status driven = drive_about(setting, {on_scan, [&] { teller.tell(); }});
  if (!driven) return driven.error();
  drive.told = teller.told();
  return drive;
}

}  // namespace cairn::bench
