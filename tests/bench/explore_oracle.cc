#include "tests/bench/explore_oracle.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/common/angle.h"
#include "core/map/update.h"
#include "core/planner/plan.h"
#include "robot_agent/input/vehicle.h"

namespace cairn::bench {
namespace {

// As the real robot at its speed.
constexpr double kLookEveryM = 0.1;
constexpr double kLookEveryRad = 0.1;
constexpr double kFootprintM = 0.3;
constexpr int kView = 20;  ///< [cells] 2.5 m.
constexpr double kHeadStartM = 2.0;
constexpr int kMostLegs = 5000;

class Oracle {
 public:
  Oracle(const agent::World& world, const DrivableGrid& ground)
      : world_(world),
        ground_(ground),
        caster_(world.surface),
        lasers_(atrv_jr_lasers()),
        integrator_(SensorModel{}),
        map_(ground.heights.cell_size_mm),
        place_m_(world.start.x_m, world.start.y_m),
        heading_rad_(world.start.yaw_rad),
        reachable_(reachable_cells(ground, place_m_)) {}

  OracleDrive run(double share) {
    look();
    drive_.places_m.push_back(place_m_);
    const auto all = std::ranges::count(reachable_, 1);
    for (int legs = 0; legs < kMostLegs; ++legs) {
      const auto next = choose();
      if (!next || sums_.back() <= (1.0 - share) * static_cast<double>(all)) break;
      drive_to(*next);
    }
    drive_.share = share_known(ground_, reachable_, [this](CellIndex c) { return seen(c); });
    return drive_;
  }

 private:
  [[nodiscard]] bool seen(CellIndex cell) const {
    return map_.cell(cell).probability >= SensorModel{}.min_probability;
  }
  [[nodiscard]] Eigen::Vector2d middle_m(CellIndex cell) const {
    return {map_.centre_m(cell.x), map_.centre_m(cell.y)};
  }

  [[nodiscard]] bool unseen(CellIndex cell) const {
    return ground_.heights.contains(cell) && reachable_[ground_.heights.at(cell)] != 0 &&
           !given_up_.contains(ground_.heights.at(cell)) && !seen(cell);
  }

  /// How many cells within view of each are yet to be seen: by sums over rectangles.
  void count_unseen() {
    const HeightGrid& heights = ground_.heights;
    const auto stride = static_cast<std::size_t>(heights.width) + 1;
    sums_.assign(stride * (static_cast<std::size_t>(heights.height) + 1), 0);
    for (std::int32_t y = 0; y < heights.height; ++y) {
      int row = 0;
      for (std::int32_t x = 0; x < heights.width; ++x) {
        row += unseen({heights.origin.x + x, heights.origin.y + y}) ? 1 : 0;
        sums_[sum_at(x + 1, y + 1)] = sums_[sum_at(x + 1, y)] + row;
      }
    }
  }
  [[nodiscard]] std::size_t sum_at(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y) * (static_cast<std::size_t>(ground_.heights.width) + 1) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] int unseen_around(std::int32_t x, std::int32_t y) const {
    const std::int32_t west = std::max(x - kView, 0);
    const std::int32_t south = std::max(y - kView, 0);
    const std::int32_t east = std::min(x + kView + 1, ground_.heights.width);
    const std::int32_t north = std::min(y + kView + 1, ground_.heights.height);
    return sums_[sum_at(east, north)] - sums_[sum_at(west, north)] - sums_[sum_at(east, south)] +
           sums_[sum_at(west, south)];
  }

  struct Choice {
    CellIndex cell;
    int unseen = 0;
    double promise = 0.0;
  };

  /// The unseen cell with the most unseen ones around it for the way to it.
  [[nodiscard]] std::optional<Choice> choose() {
    count_unseen();
    const Reach reach = reach_from(ground_, place_m_);
    const HeightGrid& heights = ground_.heights;
    std::optional<Choice> best;
    for (std::int32_t y = 0; y < heights.height; ++y) {
      for (std::int32_t x = 0; x < heights.width; ++x) {
        const CellIndex cell{heights.origin.x + x, heights.origin.y + y};
        const std::size_t at = heights.at(cell);
        if (reach.way[at] == Reach::kNone || !unseen(cell)) continue;
        const int around = unseen_around(x, y);
        const double way_m = reach.way[at] / Reach::kPerCell * map_.cell_size_m();
        const double promise = around / (kHeadStartM + way_m);
        if (!best || promise > best->promise) best = Choice{cell, around, promise};
      }
    }
    return best;
  }

  /// Until most of what was promised is seen, at the latest when it stands there.
  void drive_to(const Choice& choice) {
    const Path path =
        plan(ground_, {.start_m = place_m_, .goal_m = middle_m(choice.cell)}, PlannerConfig{});
    const double before_m = drive_.driven_m;
    for (std::size_t i = 1; i < path.points_m.size() && !enough(choice); ++i) {
      drive_along(path.points_m[i], choice);
    }
    // What cannot be seen from itself.
    if (drive_.driven_m == before_m) given_up_.insert(ground_.heights.at(choice.cell));
  }

  [[nodiscard]] bool enough(const Choice& choice) const {
    int left = 0;
    for (std::int32_t y = choice.cell.y - kView; y <= choice.cell.y + kView; ++y) {
      for (std::int32_t x = choice.cell.x - kView; x <= choice.cell.x + kView; ++x) {
        left += unseen({x, y}) ? 1 : 0;
      }
    }
    return left * 4 <= choice.unseen && seen(choice.cell);
  }

  void drive_along(const Eigen::Vector2d& to_m, const Choice& choice) {
    const Eigen::Vector2d all_m = to_m - place_m_;
    turn_to(std::atan2(all_m.y(), all_m.x()));
    while (!enough(choice) && place_m_ != to_m) {
      const Eigen::Vector2d way_m = to_m - place_m_;
      const double step_m = std::min(kLookEveryM, way_m.norm());
      place_m_ = step_m < kLookEveryM ? to_m : place_m_ + way_m * (step_m / way_m.norm());
      drive_.driven_m += step_m;
      drive_.places_m.push_back(place_m_);
      look();
    }
  }

  void turn_to(double heading_rad) {
    const double turn_rad = wrap_angle(heading_rad - heading_rad_);
    const int looks = static_cast<int>(std::abs(turn_rad) / kLookEveryRad);
    for (int i = 0; i < looks; ++i) {
      heading_rad_ += turn_rad / (looks + 1);
      look();
    }
    heading_rad_ = heading_rad;
  }

  /// Where the vehicle stands is ground, as the mapper takes it, and what its lasers see.
  void look() {
    for (double dy_m = -kFootprintM; dy_m <= kFootprintM; dy_m += kFootprintM / 4) {
      for (double dx_m = -kFootprintM; dx_m <= kFootprintM; dx_m += kFootprintM / 4) {
        const CellIndex cell = map_.cell_at(place_m_.x() + dx_m, place_m_.y() + dy_m);
        if (!ground_.heights.contains(cell)) continue;
        map_.set(cell, {ground_.heights.height_mm[ground_.heights.at(cell)], 250});
      }
    }
    const Pose robot =
        agent::Vehicle({}, world_.surface, {place_m_.x(), place_m_.y(), 0, 0, 0, heading_rad_})
            .pose();
    for (std::size_t i = 0; i < lasers_.size(); ++i) {
      const Scan scan = sweep(caster_, lasers_[i], i, robot, 0.0, random_);
      integrator_.integrate(map_, beams_in_site(scan, lasers_[i], robot, 15.0), std::nullopt,
                            nullptr);
    }
  }

  const agent::World& world_;
  const DrivableGrid& ground_;
  agent::RayCaster caster_;
  std::vector<LaserSpec> lasers_;
  ScanIntegrator integrator_;
  HeightMap map_;
  Eigen::Vector2d place_m_;
  double heading_rad_;
  std::vector<std::uint8_t> reachable_;
  std::set<std::size_t> given_up_;
  std::vector<int> sums_;
  std::mt19937_64 random_{1};
  OracleDrive drive_;
};

}  // namespace

std::vector<std::uint8_t> reachable_cells(const DrivableGrid& ground,
                                          const Eigen::Vector2d& from_m) {
  const Reach reach = reach_from(ground, from_m);
  std::vector<std::uint8_t> cells(ground.open.size());
  for (std::size_t i = 0; i < reach.way.size(); ++i) {
    cells[i] = reach.way[i] != Reach::kNone && ground.open[i] != 0 ? 1 : 0;
  }
  return cells;
}

double share_known(const DrivableGrid& ground, const std::vector<std::uint8_t>& reachable,
                   const std::function<bool(CellIndex)>& known) {
  std::size_t all = 0;
  std::size_t seen = 0;
  const HeightGrid& heights = ground.heights;
  for (std::int32_t y = heights.origin.y; y < heights.origin.y + heights.height; ++y) {
    for (std::int32_t x = heights.origin.x; x < heights.origin.x + heights.width; ++x) {
      if (reachable[heights.at({x, y})] == 0) continue;
      ++all;
      if (known({x, y})) ++seen;
    }
  }
  return static_cast<double>(seen) / static_cast<double>(std::max<std::size_t>(all, 1));
}

OracleDrive drive_greedily(const agent::World& world, const DrivableGrid& ground, double share) {
  return Oracle(world, ground).run(share);
}

}  // namespace cairn::bench
