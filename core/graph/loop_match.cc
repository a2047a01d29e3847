#include "core/graph/loop_match.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/graph/relations.h"

namespace cairn {
namespace {

/// From a frame's origin to a point of it, along the outer axes.
Eigen::Matrix4d lever_to(const Eigen::Vector3d& point_m, double yaw_rad) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return lever(c * point_m.x() - s * point_m.y(), s * point_m.x() + c * point_m.y());
}

/// One comparison's way from belief to answer.
class Comparing {
 public:
  Comparing(const LoopSide& to, const LoopSide& from, const LevelPose& T_from_to,
            const Eigen::Matrix4d& covariance, const LoopMatchConfig& config)
      : to_(to),
        from_(from),
        T_from_to_(T_from_to),
        config_(config),
        covariance_(covariance_at(to.footprint.middle_m(), T_from_to, covariance)),
        sigma_(sigma_of(covariance_)) {}

  LoopMatch run() {
    const auto least = static_cast<std::size_t>(config_.min_faces);
    const bool bare = std::min(to_.faces.points_m().size(), from_.faces.points_m().size()) < least;
    return bare ? by_heights() : by_faces();
  }

 private:
  static constexpr std::size_t kMaxRivals = 6;
  /// [m], [rad] Around the place where faces meet best.
  static constexpr double kNearM = 0.3;
  static constexpr double kNearRad = 0.03;

  [[nodiscard]] double reach_m() const {
    return std::min(config_.sigmas * sigma_.m + 2.0 * to_.surface.cell_size_m(),
                    config_.max_reach_m);
  }
  [[nodiscard]] double yaw_rad() const {
    return std::min(config_.sigmas * sigma_.rad + kNearRad, config_.max_yaw_rad);
  }

  [[nodiscard]] LoopMatch by_heights() const {
    SearchWindow window = config_.registration.window;
    window.reach_m = std::min(reach_m(), config_.max_plain_reach_m);
    window.yaw_rad = std::min(yaw_rad(), config_.max_plain_yaw_rad);
    return matched_at(T_from_to_, covariance_, window);
  }

  [[nodiscard]] LoopMatch by_faces() const {
    const Eigen::Vector2d pivot_m = to_.footprint.middle_m().head<2>();
    const std::vector<FacePlace> places =
        lay_faces(to_.faces, from_.faces, T_from_to_, pivot_m, reach_m(), yaw_rad(), kMaxRivals);
    LoopMatch match;
    match.why = "nothing that stands up meets";
    for (const FacePlace& place : places) {
      const double lead = 1.0 - static_cast<double>(place.score) / places.front().score;
      if (lead > config_.rival_lead) break;
      const LoopMatch here = matched_near(place);
      if (!match.accepted && (here.accepted || &place == &places.front())) {
        match = here;
      } else if (match.accepted && here.accepted && rivals(match, here)) {
        forget(difference(here.T_from_to, match.T_from_to), match.information);
      }
    }
    return match;
  }

  /// The heights' opinion on a place where faces meet, and what faces say of where that leads.
  [[nodiscard]] LoopMatch matched_near(const FacePlace& place) const {
    SearchWindow window = config_.registration.window;
    window.reach_m = kNearM;
    window.yaw_rad = kNearRad;
    Eigen::Matrix4d near = Eigen::Vector4d(kNearM, kNearM, 0.0, kNearRad).cwiseAbs2().asDiagonal();
    near(2, 2) = covariance_(2, 2) + kNearM * kNearM;
    LoopMatch match = matched_at(place.T_from_to, near, window);
    const FaceAgreement there = agreement(to_.faces, from_.faces, match.T_from_to);
    const FaceAgreement back = agreement(from_.faces, to_.faces, inverse(match.T_from_to));
    match.faces = there.share() < back.share() ? there : back;
    const bool few = std::min(there.seen, back.seen) < config_.min_faces;
    if (match.accepted && (few || match.faces.share() < config_.min_faces_met)) {
      match.accepted = false;
      match.why = "what stands up does not meet";
    }
    return match;
  }

  [[nodiscard]] LoopMatch matched_at(const LevelPose& T_from_to, const Eigen::Matrix4d& covariance,
                                     const SearchWindow& window) const {
    const Eigen::Vector3d& middle_m = to_.footprint.middle_m();
    RegistrationPrior prior;
    prior.T_site_submap = upright(T_from_to);
    prior.T_submap_robot.x_m = middle_m.x();
    prior.T_submap_robot.y_m = middle_m.y();
    prior.T_submap_robot.z_m = middle_m.z();
    prior.covariance = covariance;
    RegistrationConfig config = config_.registration;
    config.window = window;
    config.widen = false;
    config.min_overlap = config_.min_overlap;
    config.min_inliers = config_.min_inliers;
    LoopMatch match;
    match.registration = register_map(to_.surface, prior, from_.surface, config);
    match.T_from_to = level(match.registration.T_site_submap);
    match.information = information_at_origin(match);
    match.accepted = match.registration.accepted;
    if (!match.accepted) match.why = match.registration.why;
    return match;
  }

  /// The registration tells of the middle; the graph wants the origin.
  [[nodiscard]] Eigen::Matrix4d information_at_origin(const LoopMatch& match) const {
    const Eigen::Vector4d stiffness(config_.stiffness_m, config_.stiffness_m, config_.stiffness_m,
                                    config_.stiffness_rad);
    const Eigen::Matrix4d at_middle =
        blurred(match.registration.information, stiffness.cwiseAbs2().asDiagonal());
    const Eigen::Matrix4d J = lever_to(to_.footprint.middle_m(), match.T_from_to.yaw_rad);
    const Eigen::Matrix4d at_origin = J.transpose() * at_middle * J;
    return 0.5 * (at_origin + at_origin.transpose());
  }

  /// Whether another match contradicts one, and what was known before does not decide it.
  [[nodiscard]] bool rivals(const LoopMatch& match, const LoopMatch& other) const {
    constexpr double kSure = 25.0;    // Five sigmas.
    constexpr double kAgainst = 9.0;  // Three sigmas.
    constexpr double kWorse = 0.85;   // Walls that are a cell off.
    if (other.faces.share() < kWorse * match.faces.share()) return false;
    Eigen::Vector4d off = difference(other.T_from_to, match.T_from_to);
    return off.dot(match.information * off) > kSure &&
           surprise(other.T_from_to) < surprise(match.T_from_to) + kAgainst;
  }

  /// Takes away what the match claims to know along one direction: both of its ends fit. So a
  /// corridor ties across and not along, whatever its floor's noise says.
  static void forget(const Eigen::Vector4d& direction, Eigen::Matrix4d& information) {
    const Eigen::Vector4d pull = information * direction;
    information -= pull * pull.transpose() / direction.dot(pull);
  }

  /// Squared Mahalanobis distance of a place from the believed one, in x, y and yaw of the middle.
  [[nodiscard]] double surprise(const LevelPose& place) const {
    const Eigen::Vector3d& middle = to_.footprint.middle_m();
    const LevelPose at_middle{middle.x(), middle.y(), 0.0, 0.0};
    Eigen::Vector4d off = difference(place * at_middle, T_from_to_ * at_middle);
    off[2] = 0.0;
    const double cell_m = to_.surface.cell_size_m();
    Eigen::Matrix4d covariance = covariance_;
    covariance.diagonal() += Eigen::Vector4d(cell_m, cell_m, 1.0, kNearRad).cwiseAbs2();
    return off.dot(covariance.ldlt().solve(off));
  }

  const LoopSide& to_;
  const LoopSide& from_;
  const LevelPose& T_from_to_;
  const LoopMatchConfig& config_;
  Eigen::Matrix4d covariance_;
  PlaceSigma sigma_;
};

}  // namespace

Eigen::Matrix4d covariance_at(const Eigen::Vector3d& middle_m, const LevelPose& T_from_to,
                              const Eigen::Matrix4d& covariance) {
  const Eigen::Matrix4d J = lever_to(middle_m, T_from_to.yaw_rad);
  return J * covariance * J.transpose();
}

PlaceSigma sigma_of(const Eigen::Matrix4d& covariance_at_middle) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(
      covariance_at_middle.topLeftCorner<2, 2>(), Eigen::EigenvaluesOnly);
  return {std::sqrt(std::max(eigen.eigenvalues()[1], 0.0)),
          std::sqrt(std::max(covariance_at_middle(3, 3), 0.0))};
}

LoopMatch match_loop(const LoopSide& to, const LoopSide& from, const LevelPose& T_from_to,
                     const Eigen::Matrix4d& covariance, const LoopMatchConfig& config) {
  return Comparing(to, from, T_from_to, covariance, config).run();
}

}  // namespace cairn
