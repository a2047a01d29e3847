#include "robot_agent/pipeline/site_localization.h"

#include <cmath>
#include <utility>

namespace cairn::agent {

namespace {

/// Where a robot that does not know where it stands may be, around where it believes to be.
Eigen::Matrix4d anywhere() { return Eigen::Vector4d(100.0, 100.0, 1.0, 10.0).asDiagonal(); }

ContinuousConfig continuous_config(const MapperConfig& config, bool lost, bool given) {
  ContinuousConfig continuous = config.continuous;
  continuous.cell_size_mm = config.cell_size_mm;
  continuous.sensor_model = config.sensor_model;
  continuous.mapping_range_m = config.mapping_range_m;
  if (lost) continuous.refusals_until_lost = 1;
  // What the robot mapped itself is where it believes it to be, or the pose graph will say so.
  if (!given) continuous.registration.widen = false;
  return continuous;
}

}  // namespace

SiteLocalization::SiteLocalization(const MapperConfig& config)
    : config_(config), continuous_(continuous_config(config, !config.start_known, false)) {
  if (!config.start_known) become(LocalizationState::lost, "has not found itself in the map yet");
}

void SiteLocalization::become(LocalizationState state, std::string why) {
  state_ = state;
  why_ = std::move(why);
}

void SiteLocalization::carry(const Pose& T_site_robot) {
  begin_anew();
  continuous_.move(T_site_robot);
}

void SiteLocalization::begin_anew() {
  const bool lost = state_ == LocalizationState::lost;
  continuous_ = ContinuousLocalization(continuous_config(config_, lost, given_));
}

std::optional<SiteLocalization::Correction> SiteLocalization::localize(
    const HeightMap& old_map, const Surroundings& around, const Eigen::Matrix4d& covariance) {
  const bool lost = state_ == LocalizationState::lost;
  if (!lost && around.old_share < config_.old_share) {
    become(LocalizationState::localized, "on new ground");
    return std::nullopt;
  }
  // What the robot mapped itself holds its own errors: it is asked only by a robot that has become
  // less sure since.
  const double sigma_m = std::sqrt(covariance(0, 0) + covariance(1, 1));
  if (!lost && !around.given && sigma_m * 1000.0 < config_.cell_size_mm) return std::nullopt;
  if (around.given != given_) {
    given_ = around.given;
    begin_anew();
    return std::nullopt;
  }
  const auto answer = continuous_.localize(old_map, lost ? anywhere() : covariance);
  if (!answer) return std::nullopt;
  if (!answer->accepted) {
    refuse(*answer, around.given);
    return std::nullopt;
  }
  ++accepted_;
  become(LocalizationState::localized, "fits the map");
  return Correction{answer->T_site_robot, answer->covariance};
}

void SiteLocalization::refuse(const Registration& answer, bool given) {
  ++refused_;
  if (state_ == LocalizationState::lost) {
    why_ = answer.why;
  } else if (continuous_.state() == LocalizationState::lost && !given) {
    become(LocalizationState::unsure, "its own earlier map does not fit: " + answer.why);
    begin_anew();
  } else {
    become(continuous_.state(), answer.why);
  }
}

}  // namespace cairn::agent
