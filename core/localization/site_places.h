#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <queue>
#include <vector>

#include "core/localization/site_ground.h"
#include "core/localization/site_points.h"
#include "core/localization/site_pyramid.h"

namespace cairn {

/// One place of the robot, and the sum of what all cells differ there [units].
struct Place {
  int x = 0;  ///< [cells] In the ground's rectangle.
  int y = 0;
  double yaw_rad = 0.0;
  std::uint32_t sum = 0;
};

/// Where places are looked for, and how many turns there are.
struct PlaceSearch {
  double yaw_step_rad = 0.01745;
  double far_sigma = 0.006;            ///< [m/m] See turned_points.
  double limit_mm = 40.0;              ///< [mm] What scores worse is never asked for.
  std::size_t max_bounds = 1'000'000;  ///< Blocks divided until the search gives up.
  std::optional<SiteDisc> disc;
};

/// The places that a short-term map fits to, best first (branch and bound, best bound first: Land
/// and Doig, 1960; on blocks of shifts: Hess et al., 2016). A place's score here is the least mean
/// difference with every cell free to lie one cell beside, so that neither the grid nor a turn of
/// half a step spoils it.
class SitePlaces {
 public:
  /// Keeps references to all but `search`. Requires: cells, at most kMostTopPoints.
  SitePlaces(const SiteGround& ground, const SitePyramid& pyramid, double cell_m,
             const std::vector<ShownCell>& cells, const PlaceSearch& search);

  /// The next best place that is none of `taken`, if any scores at most `limit_mm`; what comes
  /// after scores no better. `limit_mm` never grows from call to call.
  std::optional<Place> next(double limit_mm, const std::vector<Place>& taken);

  /// The best place around, without tolerance: its sum is exact.
  [[nodiscard]] Place centred(const Place& place) const;

  [[nodiscard]] double score_mm(const Place& place) const;
  [[nodiscard]] bool same(const Place& a, const Place& b) const;
  /// [0 … 1] Share of the cells that the long-term map does not know there.
  [[nodiscard]] double unknown_share(const Place& place) const;

  /// [0 … 1] Share of the sight lines from the robot to what stands up that the long-term map
  /// says are blocked: what fits there, but could not be seen from there.
  [[nodiscard]] double blocked_share(const Place& place) const;

  /// The work was more than allowed: `next` may have missed a place.
  [[nodiscard]] bool exhausted() const { return bounds_ > search_.max_bounds; }
  [[nodiscard]] std::size_t bounds() const { return bounds_; }

 private:
  /// Robot places [x, x + 2^level) × [y, y + 2^level) at one turn, and the least any can score.
  struct Block {
    std::uint32_t bound;
    std::int16_t level, yaw, x, y;
    /// The queue gives the least bound; of equals the deepest, which ends soonest.
    friend bool operator<(const Block& a, const Block& b) {
      return a.bound != b.bound ? a.bound > b.bound : a.level > b.level;
    }
  };
  /// A square of places and turns around one.
  struct Around {
    int cells;
    int turns;
    double turn_rad;
  };

  [[nodiscard]] bool blocked(const SitePoint& point, const Place& place) const;
  [[nodiscard]] std::vector<SitePoint> points_at(double yaw_rad) const;
  [[nodiscard]] std::uint32_t sum_of(double score_mm) const;
  [[nodiscard]] bool possible(int level, int x, int y) const;
  [[nodiscard]] bool in_disc(int level, int x, int y) const;
  [[nodiscard]] int corner(int block) const;
  void open_all();
  void divide(const Block& block);
  void best_at(double yaw_rad, const Place& centre, int cells, Place& best) const;
  [[nodiscard]] Place best_around(const Place& centre, const Around& around) const;
  [[nodiscard]] std::uint32_t exact_sum(const std::vector<SitePoint>& points, int x, int y,
                                        std::uint32_t limit) const;

  const SiteGround& ground_;
  const SitePyramid& pyramid_;
  double cell_m_;
  const std::vector<ShownCell>& cells_;
  PlaceSearch search_;
  double yaw_step_rad_ = 0.0;  ///< A whole part of the circle.
  std::vector<std::vector<SitePoint>> turned_;
  std::priority_queue<Block> open_;
  std::uint32_t limit_ = 0;
  std::size_t bounds_ = 0;
};

}  // namespace cairn
