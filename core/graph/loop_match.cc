#include "core/graph/loop_match.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/graph/relations.h"

namespace cairn {
namespace {

/// From a frame's origin to a point of it, along the outer axes.
Eigen::Matrix4d lever_to(const Eigen::Vector3d& point_m, double yaw_rad) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return lever(c * point_m.x() - s * point_m.y(), s * point_m.x() + c * point_m.y());
}

SearchWindow window_for(const PlaceSigma& sigma, double cell_m, const LoopMatchConfig& config) {
  SearchWindow window = config.registration.window;
  window.reach_m = std::min(config.sigmas * sigma.m + 2.0 * cell_m, config.max_reach_m);
  window.yaw_rad =
      std::min(config.sigmas * sigma.rad + 2.0 * window.yaw_step_rad, config.max_yaw_rad);
  return window;
}

RegistrationConfig configured(const SearchWindow& window, const LoopMatchConfig& config) {
  RegistrationConfig registration = config.registration;
  registration.min_overlap = config.min_overlap;
  registration.min_inliers = config.min_inliers;
  registration.widen = window.reach_m > config.narrow_m || window.yaw_rad > config.narrow_rad;
  registration.window = window;
  if (registration.widen) {  // Straight to the bold search: what lies near is not likelier.
    registration.window.reach_m = 0.0;
    registration.window.yaw_rad = 0.0;
    registration.wide_window = window;
  }
  return registration;
}

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

LoopMatch match_loop(const HeightMap& to, const Eigen::Vector3d& middle_m, const HeightMap& from,
                     const LevelPose& T_from_to, const Eigen::Matrix4d& covariance,
                     const LoopMatchConfig& config) {
  RegistrationPrior prior;
  prior.T_site_submap = upright(T_from_to);
  prior.T_submap_robot.x_m = middle_m.x();
  prior.T_submap_robot.y_m = middle_m.y();
  prior.T_submap_robot.z_m = middle_m.z();
  prior.covariance = covariance_at(middle_m, T_from_to, covariance);
  const SearchWindow window = window_for(sigma_of(prior.covariance), to.cell_size_m(), config);

  LoopMatch match;
  const RegistrationConfig registration = configured(window, config);
  match.registration = register_map(to, prior, from, registration);
  match.accepted = match.registration.accepted && match.registration.wide == registration.widen;
  match.T_from_to = level(match.registration.T_site_submap);
  Eigen::Vector4d stiffness(config.stiffness_m, config.stiffness_m, config.stiffness_m,
                            config.stiffness_rad);
  const Eigen::Matrix4d at_middle =
      blurred(match.registration.information, stiffness.cwiseAbs2().asDiagonal());
  // The registration tells of the middle; the graph wants the origin.
  const Eigen::Matrix4d J = lever_to(middle_m, match.T_from_to.yaw_rad);
  const Eigen::Matrix4d in_from_axes = J.transpose() * at_middle * J;
  match.information = 0.5 * (in_from_axes + in_from_axes.transpose());
  return match;
}

}  // namespace cairn
