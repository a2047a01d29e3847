#include "core/localization/site_search.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>
#include <vector>

#include "core/common/angle.h"
#include "core/localization/problem.h"
#include "core/localization/site_points.h"
#include "core/localization/site_pyramid.h"

namespace cairn {

struct SiteSearch::Prepared {
  HeightMap long_term;
  SiteSearchConfig config;
  std::optional<SiteGround> ground;
  std::optional<SitePyramid> pyramid;
  std::string why;
};

namespace {

/// Places this near to each other are one.
constexpr double kSamePlaceM = 1.0;
constexpr double kSameYawRad = 0.14;

/// Robot places [x, x + 2^level) × [y, y + 2^level) at one turn, and the least any can score.
struct Block {
  std::uint32_t bound;
  std::int16_t level, yaw, x, y;

  /// The queue gives the least bound; of equals the deepest, which ends soonest.
  friend bool operator<(const Block& a, const Block& b) {
    if (a.bound != b.bound) return a.bound > b.bound;
    return a.level > b.level;
  }
};

/// A place looked at closely.
struct Place {
  double x = 0.0;  ///< [cells] In the rectangle.
  double y = 0.0;
  double yaw_rad = 0.0;
  std::uint32_t sum = std::numeric_limits<std::uint32_t>::max();
};

class Searching {
 public:
  Searching(const SiteSearchConfig& config, const SiteGround& ground, const SitePyramid& pyramid,
            double cell_m, std::vector<ShownCell> cells, const std::optional<SiteDisc>& disc)
      : config_(config),
        ground_(ground),
        pyramid_(pyramid),
        cell_m_(cell_m),
        cells_(std::move(cells)),
        disc_(disc) {
    const int yaws = static_cast<int>(std::ceil(2.0 * std::numbers::pi / config.yaw_step_rad));
    yaw_step_rad_ = 2.0 * std::numbers::pi / yaws;
    turned_.reserve(static_cast<std::size_t>(yaws));
    for (int yaw = 0; yaw < yaws; ++yaw) turned_.push_back(points_at(yaw * yaw_step_rad_));
    limit_ = sum_of(config.max_score_mm);
  }

  /// Finds the best place and what comes next; false when the work was not to be ended.
  bool run() {
    open_all();
    while (!open_.empty()) {
      const Block block = open_.top();
      if (block.bound > limit_) break;
      open_.pop();
      if (block.level > 0) {
        divide(block);
        if (bounds_ > config_.max_bounds) return false;
      } else if (!looked_at(block)) {
        if (places_.size() == config_.max_places) return false;
        look_at(block);
      }
    }
    return true;
  }

  [[nodiscard]] const std::vector<Place>& places() const { return places_; }
  [[nodiscard]] std::size_t bounds() const { return bounds_; }
  [[nodiscard]] double score_mm(std::uint32_t sum) const {
    return static_cast<double>(sum) * ground_.unit_mm / static_cast<double>(cells_.size());
  }
  /// No place that was not looked at scores better than this.
  [[nodiscard]] double limit_mm() const { return score_mm(limit_); }

  [[nodiscard]] bool same_place(const Place& a, const Place& b) const {
    return std::hypot(a.x - b.x, a.y - b.y) * cell_m_ < kSamePlaceM &&
           std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) < kSameYawRad;
  }

  /// Share of the cells that the long-term map does not know there.
  [[nodiscard]] double unknown_share(const Place& place) const {
    std::size_t unknown = 0;
    const auto x = static_cast<int>(place.x);
    const auto y = static_cast<int>(place.y);
    for (const SitePoint& point : points_at(place.yaw_rad)) {
      const HeightSpan& there = ground_.heights.at(x + point.x, y + point.y);
      unknown += there.lowest > there.highest ? 1 : 0;
    }
    return static_cast<double>(unknown) / static_cast<double>(cells_.size());
  }

 private:
  [[nodiscard]] std::uint32_t sum_of(double score_mm) const {
    return static_cast<std::uint32_t>(score_mm / ground_.unit_mm *
                                      static_cast<double>(cells_.size()));
  }

  [[nodiscard]] std::vector<SitePoint> points_at(double yaw_rad) const {
    return turned_points(cells_, yaw_rad, ground_.unit_mm, cell_m_, config_.far_sigma);
  }

  /// Whether a robot of the block may stand in the disc.
  [[nodiscard]] bool in_disc(int level, int x, int y) const {
    if (!disc_) return true;
    const double size = 1 << level;
    const auto nearest = [size](double first, double wanted) {
      return std::clamp(wanted, first, first + size);
    };
    const double wanted_x = disc_->x_m / cell_m_ - ground_.lowest.x;
    const double wanted_y = disc_->y_m / cell_m_ - ground_.lowest.y;
    return std::hypot(nearest(x, wanted_x) - wanted_x, nearest(y, wanted_y) - wanted_y) * cell_m_ <=
           disc_->radius_m;
  }

  [[nodiscard]] bool possible(int level, int x, int y) const {
    return x < ground_.heights.width - ground_.margin &&
           y < ground_.heights.height - ground_.margin &&
           pyramid_.floor(level, x, y).any() && in_disc(level, x, y);
  }

  void open_all() {
    constexpr int kTop = SitePyramid::kTop;
    std::vector<Block> blocks;
    std::vector<std::pair<int, int>> possible_blocks;
    for (int j = 0; j < pyramid_.top_rows(); ++j) {
      for (int i = 0; i < pyramid_.top_columns(); ++i) {
        if (possible(kTop, corner(i), corner(j))) possible_blocks.emplace_back(i, j);
      }
    }
    std::vector<std::uint16_t> sums;
    for (std::size_t yaw = 0; yaw < turned_.size(); ++yaw) {
      pyramid_.top_bounds(turned_[yaw], sums);
      for (const auto& [i, j] : possible_blocks) {
        const std::uint32_t bound = sums[static_cast<std::size_t>(j * pyramid_.top_stride() + i)];
        if (bound > limit_) continue;
        blocks.push_back({bound, kTop, static_cast<std::int16_t>(yaw),
                          static_cast<std::int16_t>(corner(i)),
                          static_cast<std::int16_t>(corner(j))});
      }
    }
    bounds_ += turned_.size() * possible_blocks.size();
    open_ = std::priority_queue<Block>({}, std::move(blocks));
  }

  [[nodiscard]] int corner(int block) const {
    return ground_.margin + block * SitePyramid::kTopCells;
  }

  void divide(const Block& block) {
    const int level = block.level - 1;
    const int half = 1 << level;
    for (const int y : {int{block.y}, block.y + half}) {
      for (const int x : {int{block.x}, block.x + half}) {
        if (!possible(level, x, y)) continue;
        ++bounds_;
        const std::uint32_t bound =
            pyramid_.bound(level, x, y, turned_[static_cast<std::size_t>(block.yaw)], limit_);
        if (bound > limit_) continue;
        open_.push({bound, static_cast<std::int16_t>(level), block.yaw,
                    static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)});
      }
    }
  }

  [[nodiscard]] Place place_of(const Block& block) const {
    return {static_cast<double>(block.x), static_cast<double>(block.y),
            block.yaw * yaw_step_rad_};
  }

  [[nodiscard]] bool looked_at(const Block& block) const {
    const Place place = place_of(block);
    return std::any_of(looked_at_.begin(), looked_at_.end(),
                       [&](const Place& other) { return same_place(place, other); });
  }

  /// The least difference without any tolerance in x and y.
  [[nodiscard]] std::uint32_t exact_sum(const std::vector<SitePoint>& points, int x, int y,
                                        std::uint32_t limit) const {
    const FloorSpan& floor = ground_.floor.at(x, y);
    std::uint32_t sum = 0;
    for (const SitePoint& point : points) {
      sum += static_cast<std::uint32_t>(
          least_difference(point, ground_.heights.at(x + point.x, y + point.y), floor));
      if (sum > limit) break;
    }
    return sum;
  }

  /// Walks down to the best place around.
  void look_at(const Block& block) {
    constexpr int kMostSteps = 4;
    Place best = place_of(block);
    looked_at_.push_back(best);
    for (int step = 0; step < kMostSteps; ++step) {
      const Place before = best;
      best = best_around(before);
      if (best.x == before.x && best.y == before.y && best.yaw_rad == before.yaw_rad) break;
    }
    looked_at_.push_back(best);
    places_.push_back(best);
    limit_ = std::min(limit_, static_cast<std::uint32_t>(best.sum / (1.0 - config_.min_distinctness)));
  }

  [[nodiscard]] Place best_around(const Place& centre) const {
    constexpr int kReach = 2;
    constexpr int kTurns = 4;
    Place best = centre;
    for (int turn = -kTurns; turn <= kTurns; ++turn) {
      const double yaw_rad = centre.yaw_rad + turn * 0.25 * yaw_step_rad_;
      const std::vector<SitePoint> points = points_at(yaw_rad);
      for (int dy = -kReach; dy <= kReach; ++dy) {
        for (int dx = -kReach; dx <= kReach; ++dx) {
          const int x = static_cast<int>(centre.x) + dx;
          const int y = static_cast<int>(centre.y) + dy;
          if (!inside(x, y)) continue;
          const std::uint32_t sum = exact_sum(points, x, y, best.sum);
          if (sum < best.sum) best = {static_cast<double>(x), static_cast<double>(y), yaw_rad, sum};
        }
      }
    }
    return best;
  }

  [[nodiscard]] bool inside(int x, int y) const {
    return x >= ground_.margin && y >= ground_.margin && possible(0, x, y);
  }

  const SiteSearchConfig& config_;
  const SiteGround& ground_;
  const SitePyramid& pyramid_;
  double cell_m_;
  std::vector<ShownCell> cells_;
  std::optional<SiteDisc> disc_;
  double yaw_step_rad_ = 0.0;
  std::vector<std::vector<SitePoint>> turned_;
  std::priority_queue<Block> open_;
  std::vector<Place> looked_at_;
  std::vector<Place> places_;
  std::uint32_t limit_ = 0;
  std::size_t bounds_ = 0;
};

std::string unusable(const HeightMap& short_term, const Pose& T_submap_robot) {
  if (!is_finite(T_submap_robot)) return "the robot's pose in its map is not finite";
  const double far_m =
      std::max({std::abs(T_submap_robot.x_m), std::abs(T_submap_robot.y_m),
                std::abs(T_submap_robot.z_m)});
  if (far_m > kMaxRegistrationCells * short_term.cell_size_m()) {
    return "the robot lies far from its map's origin";
  }
  return {};
}

}  // namespace

SiteSearch::SiteSearch(const HeightMap& long_term, const SiteSearchConfig& config,
                       const std::optional<SiteDisc>& disc) {
  auto prepared = std::make_unique<Prepared>(Prepared{long_term, config, {}, {}, {}});
  const int margin = static_cast<int>(std::ceil(config.reach_m / long_term.cell_size_m())) + 2;
  prepared->ground = read_site_ground(long_term, margin, disc, config.ground, prepared->why);
  if (prepared->ground) prepared->pyramid.emplace(*prepared->ground);
  prepared_ = std::move(prepared);
}

SiteSearch::~SiteSearch() = default;
SiteSearch::SiteSearch(SiteSearch&&) noexcept = default;
SiteSearch& SiteSearch::operator=(SiteSearch&&) noexcept = default;

SiteMatch SiteSearch::find(const HeightMap& short_term, const Pose& T_submap_robot,
                           const std::optional<SiteDisc>& disc) const {
  const SiteSearchConfig& config = prepared_->config;
  SiteMatch match;
  match.why = prepared_->ground ? unusable(short_term, T_submap_robot) : prepared_->why;
  if (!match.why.empty()) return match;
  std::vector<ShownCell> cells =
      shown_cells(short_term, T_submap_robot, config.reach_m, config.faces, config.flats);
  if (cells.size() < static_cast<std::size_t>(config.min_points)) {
    match.why = "the short-term map shows too little";
    return match;
  }
  const SiteGround& ground = *prepared_->ground;
  const double cell_m = short_term.cell_size_m();
  Searching searching(config, ground, *prepared_->pyramid, cell_m, std::move(cells), disc);
  const bool finished = searching.run();
  match.bounds = searching.bounds();
  match.places = searching.places().size();
  if (searching.places().empty()) {
    match.why = finished ? "it looks like no place of the map" : "too many places look alike";
    return match;
  }
  const Place best = *std::min_element(
      searching.places().begin(), searching.places().end(),
      [](const Place& a, const Place& b) { return a.sum < b.sum; });
  match.score_mm = searching.score_mm(best.sum);
  match.second_best_mm = searching.limit_mm();
  for (const Place& place : searching.places()) {
    if (searching.same_place(place, best)) continue;
    match.second_best_mm = std::min(match.second_best_mm, searching.score_mm(place.sum));
  }
  match.unknown = searching.unknown_share(best);

  RegistrationPrior prior;
  prior.T_submap_robot = T_submap_robot;
  const FloorSpan& floor = ground.floor.at(static_cast<int>(best.x), static_cast<int>(best.y));
  const RobotPlace place{(ground.lowest.x + best.x + 0.5) * cell_m,
                         (ground.lowest.y + best.y + 0.5) * cell_m,
                         (ground.datum_mm + 0.5 * (floor.lowest + floor.highest) * ground.unit_mm) / 1000.0,
                         wrap_angle(best.yaw_rad)};
  prior.T_site_submap = submap_pose(prior, place);
  prior.covariance = Eigen::Vector4d(0.1, 0.1, 0.1, 0.002).asDiagonal();
  RegistrationConfig registration = config.registration;
  registration.window = {.reach_m = 0.5, .yaw_rad = 0.035, .yaw_step_rad = 8.7e-3};
  registration.widen = false;
  match.registration = register_map(short_term, prior, prepared_->long_term, registration);
  match.T_site_robot = match.registration.accepted ? match.registration.T_site_robot
                                                   : robot_pose(prior, prior.T_site_submap);
  match.covariance = match.registration.covariance;
  if (!finished) {
    match.why = "too many places look alike";
  } else if (match.score_mm > config.max_score_mm) {
    match.why = "it looks like no place of the map";
  } else if (match.second_best_mm * (1.0 - config.min_distinctness) < match.score_mm * 0.999) {
    match.why = "another place matches as well";
  } else if (match.unknown > config.max_unknown) {
    match.why = "too little of the place is known";
  } else if (!match.registration.accepted) {
    match.why = match.registration.why;
  }
  match.accepted = match.why.empty();
  return match;
}

}  // namespace cairn
