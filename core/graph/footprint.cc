#include "core/graph/footprint.h"

#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

std::int32_t square_of(double m) { return static_cast<std::int32_t>(std::floor(m)); }

/// Level 0's keys in an order that does not hang on the map's history: sums come out the same.
std::vector<TileKey> sorted_keys(const HeightMap& map) {
  std::vector<TileKey> keys;
  for (const auto& [key, tile] : map.tiles()) {
    if (key.level == 0) keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

}  // namespace

Footprint::Footprint(const HeightMap& surface) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t known = 0;
  for (const TileKey& key : sorted_keys(surface)) {
    const Tile& tile = *surface.find(key);
    for (int i = 0; i < Tile::kCells; ++i) {
      if (!tile.known(i)) continue;
      const double x_m = surface.centre_m(key.tx * Tile::kSize + i % Tile::kSize);
      const double y_m = surface.centre_m(key.ty * Tile::kSize + i / Tile::kSize);
      sum += Eigen::Vector3d(x_m, y_m, tile.height_mm(i) / 1000.0);
      ++known;
      const Square square{square_of(y_m), square_of(x_m)};
      if (squares_.empty() || squares_.back() != square) squares_.push_back(square);
    }
  }
  std::sort(squares_.begin(), squares_.end());
  squares_.erase(std::unique(squares_.begin(), squares_.end()), squares_.end());
  if (known > 0) middle_m_ = sum / static_cast<double>(known);
  for (const Square& s : squares_) {
    const Eigen::Vector2d from_middle(s.x + 0.5 - middle_m_.x(), s.y + 0.5 - middle_m_.y());
    radius_m_ = std::max(radius_m_, from_middle.norm() + 0.71);
  }
}

bool Footprint::covers(const Square& square) const {
  return std::binary_search(squares_.begin(), squares_.end(), square);
}

double Footprint::overlap_on(const Footprint& other, const LevelPose& T_other_this) const {
  if (empty()) return 0.0;
  const double c = std::cos(T_other_this.yaw_rad);
  const double s = std::sin(T_other_this.yaw_rad);
  std::size_t common = 0;
  for (const Square& square : squares_) {
    const double x = square.x + 0.5;
    const double y = square.y + 0.5;
    const Square there{square_of(T_other_this.y_m + s * x + c * y),
                       square_of(T_other_this.x_m + c * x - s * y)};
    common += other.covers(there) ? 1 : 0;
  }
  return static_cast<double>(common) / static_cast<double>(squares_.size());
}

}  // namespace cairn
