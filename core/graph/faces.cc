#include "core/graph/faces.h"

#include <algorithm>
#include <cmath>

#include "core/localization/match_raster.h"
#include "core/localization/raster_surroundings.h"

namespace cairn {
namespace {

constexpr int kMargin = 2;  // [cells] The field falls off over so many.

/// Places nearer than this are one.
constexpr double kApartM = 0.6;
constexpr double kApartRad = 0.1;

Eigen::Vector2d turned(const Eigen::Vector2d& v, double yaw_rad) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

template <class T>
std::vector<T> thinned(std::vector<T> all, std::size_t limit) {
  if (all.size() <= limit) return all;
  std::vector<T> some;
  for (std::size_t i = 0; i < limit; ++i) some.push_back(all[i * all.size() / limit]);
  return some;
}

std::int32_t mean_height_mm(const HeightMap& surface) {
  std::int64_t sum_mm = 0;
  std::int64_t known = 0;
  for (const auto& [key, tile] : surface.tiles()) {
    for (int i = 0; i < Tile::kCells; ++i) {
      if (!tile->known(i)) continue;
      sum_mm += tile->height_mm(i);
      ++known;
    }
  }
  return known > 0 ? static_cast<std::int32_t>(sum_mm / known) : 0;
}

/// Cells that stand up from the ground around them, row by row.
std::vector<Eigen::Vector2i> standing_cells(const MatchRaster& raster) {
  constexpr int kStandsMm = 175;
  const std::vector<std::int16_t> ground = ground_under(raster, {});
  std::vector<Eigen::Vector2i> standing;
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      const bool stands =
          raster.known(x, y) && raster.at(x, y) - ground[raster.index(x, y)] > kStandsMm;
      if (stands) standing.emplace_back(x, y);
    }
  }
  return standing;
}

/// The scores of all shifts at one turn.
class Shifts {
 public:
  Shifts(const Faces& from, int reach) : from_(from), reach_(reach), side_(2 * reach + 1) {
    sums_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
  }

  void clear() { std::fill(sums_.begin(), sums_.end(), 0); }

  void add(const Eigen::Vector2i& cell) {
    const Eigen::Vector2i lowest = cell - Eigen::Vector2i(reach_, reach_);
    const int first = std::max(0, -lowest.x());
    const int end = std::min(side_, from_.width() - lowest.x());
    for (int y = std::max(0, -lowest.y()); y < std::min(side_, from_.height() - lowest.y()); ++y) {
      const std::int8_t* field = from_.row(lowest.y() + y) + lowest.x();
      std::int32_t* sums = sums_.data() + std::ptrdiff_t{y} * side_;
      for (int x = first; x < end; ++x) sums[x] += field[x];
    }
  }

  /// Shifts that agree better than their neighbours.
  [[nodiscard]] std::vector<Eigen::Vector2i> peaks() const {
    std::vector<Eigen::Vector2i> found;
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x) {
        const std::int32_t score = at(x, y);
        const bool top = score > 0 && (x == 0 || at(x - 1, y) <= score) &&
                         (x + 1 == side_ || at(x + 1, y) < score) &&
                         (y == 0 || at(x, y - 1) <= score) &&
                         (y + 1 == side_ || at(x, y + 1) < score);
        if (top) found.emplace_back(x, y);
      }
    }
    return found;
  }

  [[nodiscard]] std::int32_t at(int x, int y) const {
    return sums_[static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
                 static_cast<std::size_t>(x)];
  }

 private:
  const Faces& from_;
  int reach_;
  int side_;
  std::vector<std::int32_t> sums_;
};

bool apart(const FacePlace& a, const FacePlace& b, const Eigen::Vector2d& pivot_m) {
  const Eigen::Vector2d pa =
      turned(pivot_m, a.T_from_to.yaw_rad) + Eigen::Vector2d(a.T_from_to.x_m, a.T_from_to.y_m);
  const Eigen::Vector2d pb =
      turned(pivot_m, b.T_from_to.yaw_rad) + Eigen::Vector2d(b.T_from_to.x_m, b.T_from_to.y_m);
  return (pa - pb).norm() > kApartM ||
         std::abs(wrap_angle(a.T_from_to.yaw_rad - b.T_from_to.yaw_rad)) > kApartRad;
}

}  // namespace

Faces::Faces(const HeightMap& surface) : cell_m_(surface.cell_size_m()) {
  constexpr int kMaxSide = 2048;  // [cells] What is larger is no submap.
  const auto box = known_box(surface);
  if (!box || box->highest.x - box->lowest.x > kMaxSide ||
      box->highest.y - box->lowest.y > kMaxSide) {
    return;
  }
  lowest_ = {box->lowest.x - kMargin, box->lowest.y - kMargin};
  width_ = box->highest.x - box->lowest.x + 1 + 2 * kMargin;
  height_ = box->highest.y - box->lowest.y + 1 + 2 * kMargin;
  const MatchRaster raster =
      make_raster(surface, lowest_, width_, height_, mean_height_mm(surface), kUnknownInLong);
  field_.assign(raster.height_mm.size(), 0);
  for (std::size_t i = 0; i < field_.size(); ++i) {
    if (raster.height_mm[i] != raster.unknown) field_[i] = kFree;
  }
  for (const Eigen::Vector2i& cell : standing_cells(raster)) {
    spread(cell);
    points_m_.emplace_back((lowest_.x + cell.x() + 0.5) * cell_m_,
                           (lowest_.y + cell.y() + 0.5) * cell_m_);
  }
  points_m_ = thinned(std::move(points_m_), kMaxPoints);
}

/// A face also speaks for the cells beside it: two submaps cut a wall into cells differently.
void Faces::spread(const Eigen::Vector2i& cell) {
  for (int v = -kMargin; v <= kMargin; ++v) {
    for (int u = -kMargin; u <= kMargin; ++u) {
      const auto near = static_cast<std::int8_t>(kHit * std::exp(-0.5 * (u * u + v * v)));
      if (near < kHit / 8) continue;
      const auto i = static_cast<std::size_t>(cell.y() + v) * static_cast<std::size_t>(width_) +
                     static_cast<std::size_t>(cell.x() + u);
      field_[i] = std::max(field_[i], near);
    }
  }
}

FaceAgreement agreement(const Faces& faces, const Faces& other, const LevelPose& T_other_faces) {
  FaceAgreement sum;
  const Eigen::Vector2d t(T_other_faces.x_m, T_other_faces.y_m);
  for (const Eigen::Vector2d& p : faces.points_m()) {
    const Eigen::Vector2i cell = other.at(turned(p, T_other_faces.yaw_rad) + t);
    const std::int8_t here = other.agreement(cell.x(), cell.y());
    if (here == 0) continue;
    ++sum.seen;
    sum.met += here > Faces::kHit / 3 ? 1 : 0;  // Next to it at most.
  }
  return sum;
}

std::vector<FacePlace> lay_faces(const Faces& to, const Faces& from, const LevelPose& T_from_to,
                                 const Eigen::Vector2d& pivot_m, double reach_m, double yaw_rad,
                                 std::size_t limit) {
  constexpr double kYawStepRad = 0.0125;
  const double cell_m = from.cell_m();
  const int reach = static_cast<int>(std::ceil(reach_m / cell_m));
  const int turns = static_cast<int>(std::ceil(yaw_rad / kYawStepRad));
  const Eigen::Vector2d pivot_there =
      turned(pivot_m, T_from_to.yaw_rad) + Eigen::Vector2d(T_from_to.x_m, T_from_to.y_m);
  Shifts shifts(from, reach);
  std::vector<FacePlace> peaks;
  for (int turn = -turns; turn <= turns; ++turn) {
    const double yaw = wrap_angle(T_from_to.yaw_rad + turn * kYawStepRad);
    const Eigen::Vector2d origin = pivot_there - turned(pivot_m, yaw);
    shifts.clear();
    for (const Eigen::Vector2d& p : to.points_m()) shifts.add(from.at(turned(p, yaw) + origin));
    for (const Eigen::Vector2i& shift : shifts.peaks()) {
      const Eigen::Vector2d there =
          origin + (shift - Eigen::Vector2i::Constant(reach)).cast<double>() * cell_m;
      peaks.push_back(
          {{there.x(), there.y(), T_from_to.z_m, yaw}, shifts.at(shift.x(), shift.y())});
    }
  }
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const FacePlace& a, const FacePlace& b) { return a.score > b.score; });
  std::vector<FacePlace> best;
  for (const FacePlace& peak : peaks) {
    if (best.size() >= limit) break;
    const bool elsewhere = std::all_of(best.begin(), best.end(), [&](const FacePlace& other) {
      return apart(peak, other, pivot_m);
    });
    if (elsewhere) best.push_back(peak);
  }
  return best;
}

}  // namespace cairn
