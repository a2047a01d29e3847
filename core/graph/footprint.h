#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/graph/level_pose.h"
#include "core/map/height_map.h"

namespace cairn {

/// Where a submap knows anything, in squares of a metre: enough to tell whether two submaps are
/// worth comparing.
class Footprint {
 public:
  /// Of an empty map: empty, its middle at the origin.
  explicit Footprint(const HeightMap& surface);

  /// [m] Mean position and height of the known cells, in the submap's frame.
  [[nodiscard]] const Eigen::Vector3d& middle_m() const { return middle_m_; }
  [[nodiscard]] bool empty() const { return squares_.empty(); }
  /// [m] No known cell lies farther from the middle.
  [[nodiscard]] double radius_m() const { return radius_m_; }
  /// [0 … 1] Share of this footprint that lies on the other one.
  [[nodiscard]] double overlap_on(const Footprint& other, const LevelPose& T_other_this) const;

 private:
  struct Square {
    std::int32_t y = 0;
    std::int32_t x = 0;
    friend auto operator<=>(const Square&, const Square&) = default;
  };
  [[nodiscard]] bool covers(const Square& square) const;

  std::vector<Square> squares_;  ///< Sorted.
  Eigen::Vector3d middle_m_ = Eigen::Vector3d::Zero();
  double radius_m_ = 0.0;
};

}  // namespace cairn
