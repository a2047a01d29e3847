#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/map/height_map.h"
#include "core/pose/pose.h"
#include "robot_agent/input/world.h"

namespace cairn::bench {

/// The places of a world to which a robot could have been driven from its start: by steps of at
/// most 0.2 m, so also over kerbs that it does not climb by itself.
class Walkable {
 public:
  explicit Walkable(const agent::World& world);
  [[nodiscard]] bool at(double x_m, double y_m) const;

 private:
  [[nodiscard]] std::optional<std::size_t> cell(double x_m, double y_m) const;

  double west_m_, south_m_;
  int columns_, rows_;
  std::vector<char> reached_;
};

/// Which part of a world was mapped.
using Mapped = std::function<bool(double x_m, double y_m)>;

/// A long-term map as two lasers see the world from lanes all over its walkable ground, at poses
/// that are known to 2 cm and 0.15°.
[[nodiscard]] HeightMap surveyed(const agent::World& world, const Walkable& walkable,
                                 const Mapped& mapped, std::uint64_t seed);

/// What a robot sees in the first seconds at a place that it does not know.
struct Sighting {
  HeightMap short_term{125};
  Pose T_submap_robot;
  Pose T_site_robot;    ///< The truth.
  bool turned = false;  ///< On the spot, otherwise driven for 1 to 3 m.
};

/// The robot is put down at a random walkable place of `wanted` with a random yaw; it drives 1 to
/// 3 m, or turns half round where it cannot or every other time. When it lurches it begins again.
/// Errors: no such place.
[[nodiscard]] Result<Sighting> put_down(const agent::World& world, const Walkable& walkable,
                                        const Mapped& wanted, std::uint64_t seed);

}  // namespace cairn::bench
