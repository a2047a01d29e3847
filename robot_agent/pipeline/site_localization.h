#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/localization/continuous.h"
#include "core/localization/site_search.h"
#include "robot_agent/pipeline/mapper_config.h"

namespace cairn::agent {

/// Where the robot is in the maps of before, and whether it knows: short-term maps registered
/// against the old part of the replica (T2.2.3). Where too little of that is known around the robot
/// it is on new ground: nothing is registered and nothing refused. Only a map that the server gave
/// can tell that the robot is lost: what it mapped itself is no surer than its own way. Only a
/// search of the whole site ends that.
class SiteLocalization {
 public:
  explicit SiteLocalization(const MapperConfig& config);

  /// As of ContinuousLocalization: after each reading that moved the robot, each scan.
  void move(const Pose& T_site_robot) { continuous_.move(T_site_robot); }
  void take_scan(const Scan& scan, const LaserSpec& laser, const Pose& T_site_robot,
                 double incline_sigma_rad) {
    continuous_.take_scan(scan, laser, T_site_robot, incline_sigma_rad);
  }
  /// The robot was put elsewhere in the site without moving: what it saw lately moves along.
  void carry(const Pose& T_site_robot);

  /// Whether `localize` would register now.
  [[nodiscard]] bool due() const { return continuous_.mature(); }

  struct Correction {
    Pose T_site_robot;
    Eigen::Matrix4d covariance;
  };
  /// What is known around the robot.
  struct Surroundings {
    double old_share = 0.0;  ///< [0 … 1] Of what is known around the robot, in the old map too.
    bool given = false;      ///< The server gave it.
  };
  /// Registers the mature map, if any. Requires: not lost. `covariance`: of the robot's (x, y, z,
  /// yaw) in the site.
  std::optional<Correction> localize(const HeightMap& old_map, const Surroundings& around,
                                     const Pose& T_site_robot, const Eigen::Matrix4d& covariance);

  /// The answer of a search of the whole site, which a lost robot made. Found, the robot stays
  /// unsure until the next registration.
  void take(const SiteMatch& match);

  [[nodiscard]] LocalizationState state() const { return state_; }
  [[nodiscard]] const std::string& why() const { return why_; }
  [[nodiscard]] std::uint64_t accepted() const { return accepted_; }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  void become(LocalizationState state, std::string why);
  void begin_anew(const Pose& T_site_robot);
  void refuse(const Registration& answer, const Pose& T_site_robot);

  MapperConfig config_;
  ContinuousLocalization continuous_;
  bool given_ = false;  ///< `continuous_` is made for a map that the server gave.
  LocalizationState state_ = LocalizationState::localized;
  std::string why_ = "at the start";
  std::uint64_t accepted_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace cairn::agent
