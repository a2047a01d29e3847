#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "core/map/height_map.h"

namespace cairn {

/// Names a submap for ever: the robot's boot (a random number drawn when the agent starts) and a
/// count within it.
struct SubmapId {
  std::uint64_t boot = 0;
  std::uint32_t sequence = 0;
  friend auto operator<=>(const SubmapId&, const SubmapId&) = default;
};

struct SubmapIdHash {
  std::size_t operator()(const SubmapId& id) const {
    return std::hash<std::uint64_t>{}(id.boot * 0x9E3779B97F4A7C15ULL + id.sequence);
  }
};

/// Where a submap's frame lies in the site: integers, as on disk and wire. Submaps are level
/// (gravity is measured), so only yaw turns them.
struct SubmapPose {
  std::int32_t x_mm = 0;
  std::int32_t y_mm = 0;
  std::int32_t z_mm = 0;
  std::int32_t yaw_1e4rad = 0;  ///< [1e-4 rad], Limit: ±31416
  friend bool operator==(const SubmapPose&, const SubmapPose&) = default;
};

/// How a submap lies to the one that the same boot made before it, by dead reckoning and local
/// tracking alone: free of corrections against older maps, so that a pose graph may weigh both.
struct SubmapLink {
  SubmapPose T_previous_submap;
  std::uint16_t sigma_xy_mm = 0;       ///< [mm] Of each of x and y, of the submap's origin.
  std::uint16_t sigma_z_mm = 0;        ///< [mm]
  std::uint16_t sigma_yaw_1e4rad = 0;  ///< [1e-4 rad]
  friend bool operator==(const SubmapLink&, const SubmapLink&) = default;
};

/// [1/255] In Submap::seen_through: beyond doubt.
inline constexpr std::uint8_t kCertainlyEmpty = 255;

/// The unit of evidence (T2.2.3, design §3): what a robot saw on one stretch of its way, on its
/// own grid. Heights are above the submap's origin.
struct Submap {
  SubmapId id;
  SubmapPose T_site_submap;
  /// Empty: nothing ties this submap to the one before (the first, or the robot was lost between).
  std::optional<SubmapLink> link;
  /// The tallest surface at each cell, by the rules of T4.3.
  HeightMap surface;
  /// Where beams passed below, or grazed, what the robot's long-term map holds: per cell the height
  /// that speaks against surfaces above it by more than the sensor model's tolerance, and the
  /// probability that none stands there (kCertainlyEmpty: the robot stood there). This is how
  /// removed objects are unlearned.
  HeightMap seen_through;
  bool closed = false;  ///< The robot will add nothing more.

  Submap(SubmapId submap_id, SubmapPose pose, int cell_size_mm)
      : id(submap_id), T_site_submap(pose), surface(cell_size_mm), seen_through(cell_size_mm) {}
};

/// The layers of a submap, as they are named on disk and wire.
enum class EvidenceLayer : std::uint8_t { surface = 0, seen_through = 1 };

[[nodiscard]] inline const HeightMap& layer_of(const Submap& submap, EvidenceLayer layer) {
  return layer == EvidenceLayer::surface ? submap.surface : submap.seen_through;
}
[[nodiscard]] inline HeightMap& layer_of(Submap& submap, EvidenceLayer layer) {
  return layer == EvidenceLayer::surface ? submap.surface : submap.seen_through;
}

}  // namespace cairn
