#include "robot_agent/pipeline/site_localization.h"

#include <cmath>
#include <utility>

namespace cairn::agent {

namespace {

ContinuousConfig continuous_config(const MapperConfig& config, bool given) {
  ContinuousConfig continuous = config.continuous;
  continuous.cell_size_mm = config.cell_size_mm;
  continuous.sensor_model = config.sensor_model;
  continuous.mapping_range_m = config.mapping_range_m;
  // What the robot mapped itself is where it believes it to be, or the pose graph will say so.
  if (!given) continuous.registration.widen = false;
  return continuous;
}

}  // namespace

SiteLocalization::SiteLocalization(const MapperConfig& config)
    : config_(config), continuous_(continuous_config(config, false)) {
  if (!config.start_known) become(LocalizationState::lost, "has not found itself in the map yet");
}

void SiteLocalization::become(LocalizationState state, std::string why) {
  state_ = state;
  why_ = std::move(why);
}

void SiteLocalization::carry(const Pose& T_site_robot) { begin_anew(T_site_robot); }

void SiteLocalization::begin_anew(const Pose& T_site_robot) {
  continuous_ = ContinuousLocalization(continuous_config(config_, given_));
  continuous_.move(T_site_robot);
}

void SiteLocalization::take(const SiteMatch& match) {
  if (match.accepted) {
    ++accepted_;
    become(LocalizationState::unsure, "found in the map; waits for a registration to confirm it");
    begin_anew(match.T_site_robot);
  } else {
    ++refused_;
    why_ = match.why;
  }
}

std::optional<SiteLocalization::Correction> SiteLocalization::localize(
    const HeightMap& old_map, const Surroundings& around, const Pose& T_site_robot,
    const Eigen::Matrix4d& covariance) {
  if (around.old_share < config_.old_share) {
    become(LocalizationState::localized, "on new ground");
    return std::nullopt;
  }
  // What the robot mapped itself holds its own errors: it is asked only by a robot that has become
  // less sure since.
  const double sigma_m = std::sqrt(covariance(0, 0) + covariance(1, 1));
  if (!around.given && sigma_m < config_.ask_own_sigma_m) return std::nullopt;
  if (around.given != given_) {
    given_ = around.given;
    begin_anew(T_site_robot);
    return std::nullopt;
  }
  const auto answer = continuous_.localize(old_map, covariance);
  if (!answer) return std::nullopt;
  if (!answer->accepted) {
    refuse(*answer, T_site_robot);
    return std::nullopt;
  }
  ++accepted_;
  become(LocalizationState::localized, "fits the map");
  return Correction{answer->T_site_robot, answer->covariance};
}

void SiteLocalization::refuse(const Registration& answer, const Pose& T_site_robot) {
  ++refused_;
  if (continuous_.state() != LocalizationState::lost || given_) {
    return become(continuous_.state(), answer.why);
  }
  become(LocalizationState::unsure, "its own earlier map does not fit: " + answer.why);
  begin_anew(T_site_robot);
}

}  // namespace cairn::agent
