#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/graph/level_pose.h"
#include "core/map/height_map.h"

namespace cairn {

/// What stands up on a submap (walls, trunks, steps), and where it saw that nothing does. Ground
/// looks alike everywhere, so this is what tells places apart.
class Faces {
 public:
  Faces() = default;
  explicit Faces(const HeightMap& surface);

  /// [m] Middles of the cells that stand up, in the submap's frame; evenly thinned out to
  /// kMaxPoints.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& points_m() const { return points_m_; }
  [[nodiscard]] double cell_m() const { return cell_m_; }

  /// How well something that stands here agrees: kHit on a face, falling off beside it, kFree where
  /// only ground was seen, 0 where nothing is known.
  static constexpr std::int8_t kHit = 64;
  static constexpr std::int8_t kFree = -32;
  [[nodiscard]] std::int8_t agreement(int x, int y) const {
    return x < 0 || y < 0 || x >= width_ || y >= height_
               ? std::int8_t{0}
               : field_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                        static_cast<std::size_t>(x)];
  }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] const std::int8_t* row(int y) const {
    return field_.data() + static_cast<std::ptrdiff_t>(y) * width_;
  }
  /// The cell of the field at a point of the submap's frame.
  [[nodiscard]] Eigen::Vector2i at(const Eigen::Vector2d& p_m) const {
    return {static_cast<int>(std::floor(p_m.x() / cell_m_)) - lowest_.x,
            static_cast<int>(std::floor(p_m.y() / cell_m_)) - lowest_.y};
  }

  static constexpr std::size_t kMaxPoints = 800;

 private:
  void spread(const Eigen::Vector2i& cell);

  double cell_m_ = 1.0;
  CellIndex lowest_;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::int8_t> field_;
  std::vector<Eigen::Vector2d> points_m_;
};

/// [1] How many faces lie where the other submap knows the place, and how many of them on a face.
struct FaceAgreement {
  int seen = 0;
  int met = 0;
  [[nodiscard]] double share() const { return seen > 0 ? static_cast<double>(met) / seen : 0.0; }
};
[[nodiscard]] FaceAgreement agreement(const Faces& faces, const Faces& other,
                                      const LevelPose& T_other_faces);

/// A place where two submaps' faces meet.
struct FacePlace {
  LevelPose T_from_to;
  std::int32_t score = 0;  ///< Sum of agreements.
};

/// All places around `T_from_to` are tried: `to` is turned about the point `pivot_m` of its frame
/// by up to ±yaw_rad and shifted by up to ±reach_m. The best place and then the best ones
/// elsewhere, at most `limit`.
[[nodiscard]] std::vector<FacePlace> lay_faces(const Faces& to, const Faces& from,
                                               const LevelPose& T_from_to,
                                               const Eigen::Vector2d& pivot_m, double reach_m,
                                               double yaw_rad, std::size_t limit);

}  // namespace cairn
