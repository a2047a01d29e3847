#include "core/localization/site_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/common/angle.h"

namespace cairn {
namespace {

/// Places this near to each other are one.
constexpr double kSamePlaceM = 1.0;
constexpr double kSameYawRad = 0.14;

/// [mm] The lower laser above the robot's foot.
constexpr double kLaserMm = 400.0;
/// [cells] So near to either end of a sight line the grid is too coarse.
constexpr int kClearCells = 5;

}  // namespace

SitePlaces::SitePlaces(const SiteGround& ground, const SitePyramid& pyramid, double cell_m,
                       const std::vector<ShownCell>& cells, const PlaceSearch& search)
    : ground_(ground), pyramid_(pyramid), cell_m_(cell_m), cells_(cells), search_(search) {
  const int yaws = static_cast<int>(std::ceil(2.0 * std::numbers::pi / search.yaw_step_rad));
  yaw_step_rad_ = 2.0 * std::numbers::pi / yaws;
  turned_.reserve(static_cast<std::size_t>(yaws));
  for (int yaw = 0; yaw < yaws; ++yaw) turned_.push_back(points_at(yaw * yaw_step_rad_));
  limit_ = sum_of(search.limit_mm);
  open_all();
}

std::optional<Place> SitePlaces::next(double limit_mm, const std::vector<Place>& taken) {
  limit_ = std::min(limit_, sum_of(limit_mm));
  while (!open_.empty() && open_.top().bound <= limit_ && !exhausted()) {
    const Block block = open_.top();
    open_.pop();
    if (block.level > 0) {
      divide(block);
      continue;
    }
    const Place place{block.x, block.y, block.yaw * yaw_step_rad_, block.bound};
    const auto is_this = [&](const Place& other) { return same(place, other); };
    if (std::none_of(taken.begin(), taken.end(), is_this)) return place;
  }
  return std::nullopt;
}

Place SitePlaces::centred(const Place& place) const {
  Place start = place;
  start.sum = std::numeric_limits<std::uint32_t>::max();
  const Place near = best_around(start, {6, 4, 0.5 * yaw_step_rad_});
  return best_around(near, {1, 2, 0.25 * yaw_step_rad_});
}

double SitePlaces::score_mm(const Place& place) const {
  return static_cast<double>(place.sum) * ground_.unit_mm / static_cast<double>(cells_.size());
}

bool SitePlaces::same(const Place& a, const Place& b) const {
  return std::hypot(a.x - b.x, a.y - b.y) * cell_m_ < kSamePlaceM &&
         std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) < kSameYawRad;
}

double SitePlaces::unknown_share(const Place& place) const {
  std::size_t unknown = 0;
  for (const SitePoint& point : points_at(place.yaw_rad)) {
    const HeightSpan& there = ground_.heights.at(place.x + point.x, place.y + point.y);
    unknown += there.lowest > there.highest ? 1 : 0;
  }
  return static_cast<double>(unknown) / static_cast<double>(cells_.size());
}

/// Whether something stands in the way that is higher than the line from the lower laser to the
/// point.
bool SitePlaces::blocked(const SitePoint& point, const Place& place) const {
  const int steps = std::max(std::abs(point.x), std::abs(point.y));
  const FloorSpan& floor = ground_.floor.at(place.x, place.y);
  const double laser = kLaserMm / ground_.unit_mm;
  for (int i = kClearCells; i < steps - kClearCells; ++i) {
    const double part = static_cast<double>(i) / steps;
    const HeightSpan& there =
        ground_.heights.at(place.x + static_cast<int>(std::lround(part * point.x)),
                           place.y + static_cast<int>(std::lround(part * point.y)));
    if (there.lowest >= there.highest) continue;  // Unknown, or ground.
    const double line = floor.highest + laser + part * (point.highest - laser);
    if (there.highest - ground_.above_face > line) return true;
  }
  return false;
}

double SitePlaces::blocked_share(const Place& place) const {
  int lines = 0;
  int blocked_lines = 0;
  const std::vector<SitePoint> points = points_at(place.yaw_rad);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int steps = std::max(std::abs(points[i].x), std::abs(points[i].y));
    if (!cells_[i].face || steps <= 2 * kClearCells) continue;
    ++lines;
    blocked_lines += blocked(points[i], place) ? 1 : 0;
  }
  return lines == 0 ? 0.0 : static_cast<double>(blocked_lines) / lines;
}

std::vector<SitePoint> SitePlaces::points_at(double yaw_rad) const {
  return turned_points(cells_, yaw_rad, ground_.unit_mm, cell_m_, search_.far_sigma);
}

std::uint32_t SitePlaces::sum_of(double score_mm) const {
  return static_cast<std::uint32_t>(
      std::floor(score_mm / ground_.unit_mm * static_cast<double>(cells_.size())));
}

bool SitePlaces::possible(int level, int x, int y) const {
  return x < ground_.heights.width - ground_.margin &&
         y < ground_.heights.height - ground_.margin && pyramid_.floor(level, x, y).any() &&
         in_disc(level, x, y);
}

/// Whether some robot of the block stands in the disc.
bool SitePlaces::in_disc(int level, int x, int y) const {
  if (!search_.disc) return true;
  const double size = 1 << level;
  const double wanted_x = search_.disc->x_m / cell_m_ - ground_.lowest.x;
  const double wanted_y = search_.disc->y_m / cell_m_ - ground_.lowest.y;
  const double away_x = std::clamp(wanted_x, double(x), x + size) - wanted_x;
  const double away_y = std::clamp(wanted_y, double(y), y + size) - wanted_y;
  return std::hypot(away_x, away_y) * cell_m_ <= search_.disc->radius_m;
}

int SitePlaces::corner(int block) const { return ground_.margin + block * SitePyramid::kTopCells; }

void SitePlaces::open_all() {
  constexpr int kTop = SitePyramid::kTop;
  std::vector<std::pair<int, int>> places;
  for (int j = 0; j < pyramid_.top_rows(); ++j) {
    for (int i = 0; i < pyramid_.top_columns(); ++i) {
      if (possible(kTop, corner(i), corner(j))) places.emplace_back(i, j);
    }
  }
  std::vector<Block> blocks;
  std::vector<std::uint16_t> sums;
  for (std::size_t yaw = 0; yaw < turned_.size(); ++yaw) {
    pyramid_.top_bounds(turned_[yaw], sums);
    for (const auto& [i, j] : places) {
      const std::uint32_t bound =
          sums[static_cast<std::size_t>(j) * static_cast<std::size_t>(pyramid_.top_stride()) +
               static_cast<std::size_t>(i)];
      if (bound > limit_) continue;
      blocks.push_back({bound, kTop, static_cast<std::int16_t>(yaw),
                        static_cast<std::int16_t>(corner(i)),
                        static_cast<std::int16_t>(corner(j))});
    }
  }
  open_ = std::priority_queue<Block>({}, std::move(blocks));
}

void SitePlaces::divide(const Block& block) {
  const int level = block.level - 1;
  const int half = 1 << level;
  for (const int y : {int{block.y}, block.y + half}) {
    for (const int x : {int{block.x}, block.x + half}) {
      if (!possible(level, x, y)) continue;
      ++bounds_;
      const std::uint32_t bound =
          pyramid_.bound(level, x, y, turned_[static_cast<std::size_t>(block.yaw)], limit_);
      if (bound > limit_) continue;
      open_.push({bound, static_cast<std::int16_t>(level), block.yaw, static_cast<std::int16_t>(x),
                  static_cast<std::int16_t>(y)});
    }
  }
}

std::uint32_t SitePlaces::exact_sum(const std::vector<SitePoint>& points, int x, int y,
                                    std::uint32_t limit) const {
  const FloorSpan& floor = ground_.floor.at(x, y);
  std::uint32_t sum = 0;
  for (const SitePoint& point : points) {
    const HeightSpan& there = ground_.heights.at(x + point.x, y + point.y);
    sum += static_cast<std::uint32_t>(least_difference(point, there, floor));
    if (sum > limit) break;
  }
  return sum;
}

void SitePlaces::best_at(double yaw_rad, const Place& centre, int cells, Place& best) const {
  const std::vector<SitePoint> points = points_at(yaw_rad);
  for (int y = centre.y - cells; y <= centre.y + cells; ++y) {
    for (int x = centre.x - cells; x <= centre.x + cells; ++x) {
      if (x < ground_.margin || y < ground_.margin || !possible(0, x, y)) continue;
      const std::uint32_t sum = exact_sum(points, x, y, best.sum);
      if (sum < best.sum) best = {x, y, yaw_rad, sum};
    }
  }
}

Place SitePlaces::best_around(const Place& centre, const Around& around) const {
  Place best = centre;
  for (int turn = -around.turns; turn <= around.turns; ++turn) {
    best_at(centre.yaw_rad + turn * around.turn_rad, centre, around.cells, best);
  }
  return best;
}

}  // namespace cairn
