#include "tests/bench/explore_oracle.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/map/update.h"
#include "core/planner/plan.h"
#include "robot_agent/input/vehicle.h"

namespace cairn::bench {
namespace {

constexpr double kLookEveryM = 0.25;
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
        reachable_(reachable_cells(ground, place_m_)) {}

  OracleDrive run(double share) {
    look(world_.start.yaw_rad);
    drive_.places_m.push_back(place_m_);
    for (int legs = 0; legs < kMostLegs; ++legs) {
      drive_.share = share_known(ground_, reachable_, [this](CellIndex c) { return seen(c); });
      const auto next = drive_.share < share ? nearest_unseen() : std::nullopt;
      if (!next || !drive_to(*next)) break;
    }
    return drive_;
  }

 private:
  [[nodiscard]] bool seen(CellIndex cell) const {
    return map_.cell(cell).probability >= SensorModel{}.min_probability;
  }
  [[nodiscard]] Eigen::Vector2d middle_m(CellIndex cell) const {
    return {map_.centre_m(cell.x), map_.centre_m(cell.y)};
  }

  [[nodiscard]] std::optional<CellIndex> nearest_unseen() const {
    const Reach reach = reach_from(ground_, place_m_);
    std::optional<CellIndex> nearest;
    std::uint32_t least = Reach::kNone;
    const HeightGrid& heights = ground_.heights;
    for (std::int32_t y = heights.origin.y; y < heights.origin.y + heights.height; ++y) {
      for (std::int32_t x = heights.origin.x; x < heights.origin.x + heights.width; ++x) {
        const std::size_t at = heights.at({x, y});
        if (reachable_[at] == 0 || reach.way[at] >= least) continue;
        if (given_up_.contains(at) || seen({x, y})) continue;
        least = reach.way[at];
        nearest = CellIndex{x, y};
      }
    }
    return nearest;
  }

  /// Until the cell is seen, at the latest when it stands there.
  bool drive_to(CellIndex cell) {
    const Path path =
        plan(ground_, {.start_m = place_m_, .goal_m = middle_m(cell)}, PlannerConfig{});
    given_up_.insert(ground_.heights.at(cell));  // What cannot be seen from itself.
    if (path.status != PathStatus::complete) return true;
    for (std::size_t i = 1; i < path.points_m.size() && !seen(cell); ++i) {
      drive_along(path.points_m[i], cell);
    }
    return true;
  }

  void drive_along(const Eigen::Vector2d& to_m, CellIndex cell) {
    while (!seen(cell) && place_m_ != to_m) {
      const Eigen::Vector2d way_m = to_m - place_m_;
      const double step_m = std::min(kLookEveryM, way_m.norm());
      place_m_ = step_m < kLookEveryM ? to_m : place_m_ + way_m * (step_m / way_m.norm());
      drive_.driven_m += step_m;
      drive_.places_m.push_back(place_m_);
      look(std::atan2(way_m.y(), way_m.x()));
    }
  }

  void look(double heading_rad) {
    const Pose robot =
        agent::Vehicle({}, world_.surface, {place_m_.x(), place_m_.y(), 0, 0, 0, heading_rad})
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
  std::vector<std::uint8_t> reachable_;
  std::set<std::size_t> given_up_;
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
