#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/localization/tracking_points.h"

namespace cairn {

struct TrackingMapConfig {
  double radius_m = 0.4;    ///< [m] Surfaces are looked for this far around a point. [Limit: > 0]
  double width_m = 0.08;    ///< [m] What was seen within about this of a place makes the surface.
  double merge_m = 0.04;    ///< [m] Points of one surface that are nearer become one, their mean.
  double most_seen = 30.0;  ///< [-] A mean of so many follows new points like one of so many.
};

/// The surfaces that the robot met lately, in its local frame; found by place.
class TrackingMap {
 public:
  explicit TrackingMap(const TrackingMapConfig& config) : config_(config) {}

  /// [points] Held at most; further ones are left out until some are forgotten.
  static constexpr std::size_t kMaxPoints = 200'000;

  /// What a sweep met after so much way.
  void add(const std::vector<SurfacePoint>& points, double way_m);
  /// Forgets what was not seen since this much way.
  void forget_before(double way_m);
  void clear();

  /// The surface near a point that faces the same way as `normal`.
  struct Surface {
    double distance_m;       ///< Of the point, above it.
    Eigen::Vector2d normal;  ///< Unit length.
  };
  /// Moving least squares over what was seen of it (Kolluri 2008; Deschaud 2018): nothing when
  /// there is none within the radius.
  [[nodiscard]] std::optional<Surface> surface_at(const SurfacePoint& point) const;

  [[nodiscard]] bool empty() const { return points_ == 0; }

 private:
  struct Seen {
    SurfacePoint mean;
    double times;
    double last_m;
  };
  using Square = std::vector<Seen>;

  [[nodiscard]] std::uint64_t square_of(const Eigen::Vector2d& p_m, int dx, int dy) const;
  void merge(const SurfacePoint& point, double way_m, Square& square);

  TrackingMapConfig config_;
  std::unordered_map<std::uint64_t, Square> squares_;  ///< radius_m wide.
  std::size_t points_ = 0;
};

}  // namespace cairn
