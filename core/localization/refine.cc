#include "core/localization/refine.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/common/angle.h"

namespace cairn {
namespace {

/// The long-term surface at one point.
struct Surface {
  double height_mm;
  double per_x, per_y;  ///< [mm/m]
};

/// The 4 × 4 cells around the square (x, y) … (x+1, y+1).
struct Surroundings {
  double relief_mm = 0.0;           ///< Between the lowest and the highest known height.
  double per_x = 0.0, per_y = 0.0;  ///< [mm per cell] Of the plane through them.
  bool complete = false;            ///< All are known: the plane means something.
};

Surroundings surroundings(const MatchRaster& map, int x, int y) {
  int lowest = kMatchLimitMm;
  int highest = -kMatchLimitMm;
  int known = 0;
  int along_x = 0;  // Heights times twice their distance from the middle.
  int along_y = 0;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 2, map.height - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 2, map.width - 1); ++u) {
      if (!map.known(u, v)) continue;
      const int height_mm = map.at(u, v);
      lowest = std::min(lowest, height_mm);
      highest = std::max(highest, height_mm);
      along_x += height_mm * (2 * (u - x) - 1);
      along_y += height_mm * (2 * (v - y) - 1);
      ++known;
    }
  }
  constexpr double kSquares = 4.0 * (9 + 1 + 1 + 9) / 2.0;  // Of the doubled distances, halved.
  return {static_cast<double>(highest - lowest), along_x / kSquares, along_y / kSquares,
          known == 16};
}

/// The heights at the corners of a square of four neighbouring cells.
struct Corners {
  double h00, h10, h01, h11;

  void clip(double limit_mm) {
    for (double* h : {&h00, &h10, &h01, &h11}) *h = std::min(*h, limit_mm);
  }
};

std::optional<Corners> corners_at(const LongTermRelief& relief, int x, int y) {
  const MatchRaster& map = relief.heights;
  if (x < 0 || y < 0 || x + 1 >= map.width || y + 1 >= map.height) return std::nullopt;
  if (map.known(x, y) && map.known(x + 1, y) && map.known(x, y + 1) && map.known(x + 1, y + 1)) {
    return Corners{static_cast<double>(map.at(x, y)), static_cast<double>(map.at(x + 1, y)),
                   static_cast<double>(map.at(x, y + 1)),
                   static_cast<double>(map.at(x + 1, y + 1))};
  }
  return std::nullopt;
}

Surface surface_between(const Corners& c, double u, double v, double cell_m) {
  const double h10 = c.h10 - c.h00;
  const double h01 = c.h01 - c.h00;
  const double h11 = c.h11 - c.h00 - h10 - h01;
  return {c.h00 + h10 * u + h01 * v + h11 * u * v, (h10 + h11 * v) / cell_m,
          (h01 + h11 * u) / cell_m};
}

/// The normal equations at one place, and how well it fits there.
struct Normal {
  Eigen::Matrix4d H = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  std::size_t overlap = 0;
  std::size_t inliers = 0;
  double misfit = 0.0;
  double weights = 0.0;  ///< In units of 1/σ²: how many cells count.
  double squares = 0.0;  ///< Weighted (residual / σ)².
  double weights_mm = 0.0;
  double squares_mm = 0.0;
};

class NormalEquations {
 public:
  NormalEquations(const LongTermRelief& map, const RobotPlace& place, const RefineConfig& config)
      : map_(map),
        place_(place),
        config_(config),
        cos_(std::cos(place[3])),
        sin_(std::sin(place[3])) {}

  void add(const ShortTermCell& cell) {
    const double x = cos_ * cell.from_robot_m.x() - sin_ * cell.from_robot_m.y();
    const double y = sin_ * cell.from_robot_m.x() + cos_ * cell.from_robot_m.y();
    const double x_cells = (place_[0] + x) / map_.cell_m - map_.heights.lowest.x - 0.5;
    const double y_cells = (place_[1] + y) / map_.cell_m - map_.heights.lowest.y - 0.5;
    const int column = static_cast<int>(std::floor(x_cells));
    const int row = static_cast<int>(std::floor(y_cells));
    auto corners = corners_at(map_, column, row);
    if (!corners) return;
    const double foot_mm = place_[2] * 1000.0 - map_.heights.datum_mm;
    double height_mm = foot_mm + cell.height_mm;
    const Surroundings around = surroundings(map_.heights, column, row);
    double height_range_mm = around.relief_mm;
    double share = config_.relief_share;
    const int nearest_x = static_cast<int>(std::floor(x_cells + 0.5));
    const int nearest_y = static_cast<int>(std::floor(y_cells + 0.5));
    const std::size_t nearest = map_.heights.index(nearest_x, nearest_y);
    if (map_.face[nearest] != 0) {
      const double limit_mm = map_.limit_mm(nearest_x, nearest_y, foot_mm + cell.top_mm);
      corners->clip(limit_mm);
      height_mm = std::min(height_mm, limit_mm);
      height_range_mm = std::min(height_range_mm, limit_mm - map_.ground[nearest]);
      share = config_.side_face_relief_share;
    }
    Surface surface = surface_between(*corners, x_cells - column, y_cells - row, map_.cell_m);
    if (height_range_mm < config_.edge_relief_mm) flatten(around, surface);
    const Eigen::Vector4d J(surface.per_x, surface.per_y, -1000.0,
                            surface.per_y * x - surface.per_x * y);
    add(J, surface.height_mm - height_mm, std::hypot(share * height_range_mm, cell.incline_mm));
  }

  [[nodiscard]] const Normal& result() const { return normal_; }

 private:
  /// Between neighbouring cells of even ground the noise of their heights looks like slopes, and
  /// many together like knowledge. The plane through 16 cells has five times less of it.
  void flatten(const Surroundings& around, Surface& surface) const {
    const double slope = std::hypot(around.per_x, around.per_y);
    const bool is_slope = around.complete && slope >= config_.noise_slope * 1000.0 * map_.cell_m;
    surface.per_x = is_slope ? around.per_x / map_.cell_m : 0.0;
    surface.per_y = is_slope ? around.per_y / map_.cell_m : 0.0;
  }

  void add(const Eigen::Vector4d& J, double residual_mm, double spread_mm) {
    const double variance = config_.flat_sigma_mm * config_.flat_sigma_mm + spread_mm * spread_mm;
    const double squared = residual_mm * residual_mm / variance;
    const double fit = 1.0 / (1.0 + squared / kMostMisfit);
    const double weight = fit * fit / variance;
    normal_.H.noalias() += weight * J * J.transpose();
    normal_.b.noalias() -= weight * residual_mm * J;
    normal_.misfit += squared * fit;
    ++normal_.overlap;
    normal_.inliers += squared < 9.0 ? 1 : 0;
    normal_.weights += fit * fit;
    normal_.squares += fit * fit * squared;
    normal_.weights_mm += weight;
    normal_.squares_mm += weight * residual_mm * residual_mm;
  }

  const LongTermRelief& map_;
  const RobotPlace& place_;
  const RefineConfig& config_;
  double cos_, sin_;
  Normal normal_;
};

Normal normal_at(const std::vector<ShortTermCell>& cells, const LongTermRelief& map,
                 const RobotPlace& place, const RefineConfig& config) {
  NormalEquations equations(map, place, config);
  for (const ShortTermCell& cell : cells) equations.add(cell);
  return equations.result();
}

/// Cells that err together, and heights that fit worse than expected, weaken a match.
double opinion_share(const Normal& normal, const RefineConfig& config) {
  const double misfit = std::max(normal.squares / std::max(normal.weights, 1e-9), 1.0);
  return 1.0 / (config.cells_per_opinion * misfit);
}

/// What the match says in the directions that it shows at all: noise of the heights looks like a
/// little information in every direction (solution remapping, Zhang et al. 2016).
struct Evidence {
  Eigen::Matrix4d information;
  Eigen::Vector4d pull;
};

Evidence observable_part(const Normal& normal, const RefineConfig& config) {
  constexpr double kLeverM = 3.0;  // A turn moves what lies this far away; makes units alike.
  const Eigen::Vector4d scale(1.0, 1.0, 1.0, kLeverM);
  const double share = opinion_share(normal, config);
  const Eigen::Matrix4d H =
      share * scale.cwiseInverse().asDiagonal() * normal.H * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(H);
  const double least = 1.0 / (config.blind_sigma_m * config.blind_sigma_m);
  Eigen::Matrix4d seen = Eigen::Matrix4d::Zero();
  Eigen::Matrix4d kept = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 4; ++i) {
    if (eigen.eigenvalues()[i] < least) continue;
    const Eigen::Vector4d axis = eigen.eigenvectors().col(i);
    seen += axis * axis.transpose();
    kept += eigen.eigenvalues()[i] * axis * axis.transpose();
  }
  const Eigen::Vector4d b = share * scale.cwiseInverse().cwiseProduct(normal.b);
  return {scale.asDiagonal() * kept * scale.asDiagonal(), scale.cwiseProduct(seen * b)};
}

RobotPlace difference(const RobotPlace& a, const RobotPlace& b) {
  RobotPlace d = a - b;
  d[3] = wrap_angle(d[3]);
  return d;
}

/// No step leaves the neighbourhood in which the surface was looked at.
RobotPlace limited(RobotPlace step) {
  constexpr double kLongestM = 0.1;
  constexpr double kLargestTurnRad = 0.02;
  const double way = step.head<2>().norm();
  if (way > kLongestM) step.head<2>() *= kLongestM / way;
  step[3] = std::clamp(step[3], -kLargestTurnRad, kLargestTurnRad);
  return step;
}

bool is_small(const RobotPlace& step) {
  return step.head<3>().norm() < 1e-5 && std::abs(step[3]) < 1e-6;
}

/// Where a part of the short-term map would rather be, from the place of the whole.
struct Wish {
  Eigen::Vector4d step;
  Eigen::Matrix4d covariance;
};

Wish wish_of(const std::vector<ShortTermCell>& cells, const LongTermRelief& map,
             const RobotPlace& place, const RefineConfig& config) {
  // What a part does not show it does not wish, but may be off by this much.
  constexpr double kBlindM = 0.5;
  constexpr double kBlindRad = 0.2;
  const Eigen::Vector4d sigma(kBlindM, kBlindM, kBlindM, kBlindRad);
  const Evidence evidence = observable_part(normal_at(cells, map, place, config), config);
  Wish wish;
  wish.covariance =
      (evidence.information + Eigen::Matrix4d(sigma.cwiseAbs2().cwiseInverse().asDiagonal()))
          .inverse();
  wish.step = wish.covariance * evidence.pull;
  return wish;
}

double discord_of(std::vector<ShortTermCell> cells, const LongTermRelief& map,
                  const RobotPlace& place, const RefineConfig& config) {
  constexpr int kCuts = 4;
  double worst = 0.0;
  for (int cut = 0; cut < kCuts; ++cut) {
    const double angle = cut * std::numbers::pi / kCuts;
    const Eigen::Vector2d across(std::cos(angle), std::sin(angle));
    const auto middle = cells.begin() + static_cast<std::ptrdiff_t>(cells.size() / 2);
    std::nth_element(cells.begin(), middle, cells.end(),
                     [&](const ShortTermCell& a, const ShortTermCell& b) {
                       return a.from_robot_m.dot(across) < b.from_robot_m.dot(across);
                     });
    const Wish one = wish_of({cells.begin(), middle}, map, place, config);
    const Wish other = wish_of({middle, cells.end()}, map, place, config);
    const Eigen::Vector4d apart = one.step - other.step;
    worst = std::max(worst, apart.dot((one.covariance + other.covariance).ldlt().solve(apart)));
  }
  return worst;
}

}  // namespace

std::optional<Refinement> refine(const std::vector<ShortTermCell>& cells,
                                 const LongTermRelief& long_term, const RobotPlace& prior,
                                 const Eigen::Matrix4d& prior_information, const RobotPlace& start,
                                 const RefineConfig& config) {
  RobotPlace place = start;
  for (int i = 0; i < config.max_iterations; ++i) {
    const Normal normal = normal_at(cells, long_term, place, config);
    if (normal.overlap == 0) return std::nullopt;
    const Evidence evidence = observable_part(normal, config);
    const Eigen::Matrix4d H = evidence.information / config.registered_times + prior_information;
    const Eigen::Vector4d b =
        evidence.pull / config.registered_times - prior_information * difference(place, prior);
    const RobotPlace step = limited(H.ldlt().solve(b));
    if (!step.allFinite()) return std::nullopt;
    place += step;
    if (is_small(step)) break;
  }
  const Normal normal = normal_at(cells, long_term, place, config);
  if (normal.overlap == 0) return std::nullopt;
  Refinement result;
  result.place = place;
  result.place[3] = wrap_angle(place[3]);
  result.information = observable_part(normal, config).information;
  result.covariance = (result.information / config.registered_times + prior_information).inverse();
  result.overlap = normal.overlap;
  result.inliers = static_cast<double>(normal.inliers) / static_cast<double>(normal.overlap);
  result.misfit = normal.misfit / static_cast<double>(normal.overlap);
  result.opinions = static_cast<double>(normal.overlap) / config.cells_per_opinion;
  result.residual_mm = std::sqrt(normal.squares_mm / normal.weights_mm);
  result.discord = discord_of(cells, long_term, place, config);
  return result;
}

}  // namespace cairn
