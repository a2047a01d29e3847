#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/localization/registration.h"
#include "core/map/height_map.h"
#include "core/map/sensor_model.h"
#include "core/map/update.h"
#include "core/pose/pose.h"
#include "core/sensor/laser.h"

namespace cairn {

struct ContinuousConfig {
  RegistrationConfig registration;
  /// Searched by a lost robot.
  SearchWindow lost_window{.reach_m = 8.0, .yaw_rad = 1.047, .yaw_step_rad = 0.0175};
  SensorModel sensor_model;
  int cell_size_mm = 125;  ///< [mm] As the long-term map's.
  /// A short-term map matures after this much way [m] and turning [rad], added up in parts.
  double mature_distance_m = 1.0;
  double mature_turn_rad = 0.8;
  int overlapping_maps = 4;  ///< [Limit: 1 … 16] So many grow at a time.
  /// In a row. Maps that overlap share scans and are refused together: three lives of four maps.
  int refusals_until_lost = 12;
  double mapping_range_m = 15.0;  ///< [m] Beams count this far.
  /// [-] A correction whose innovation is larger waits until the next map confirms it
  /// (squared Mahalanobis distance; 4 degrees of freedom: 5 % are beyond 9.5). What only the wide
  /// search found, and whatever a lost robot finds, waits for a map that shares no scan with it.
  double confirm_innovation = 9.5;
  /// [-] Two corrections agree when they differ by less (0.1 % are beyond).
  double agreement = 18.5;
};

enum class LocalizationState : std::uint8_t {
  localized,  ///< The newest map was registered, or none is mature yet.
  unsure,     ///< The newest were refused, or wait for one that confirms them.
  lost,       ///< Refused many times in a row: the pose is a guess. Two maps without a common
              ///< scan that agree where they are end it.
};

/// Continuous localization (T2.2.3, Fig. 5; T4.3.3): several overlapping short-term maps, each
/// begun a part of the way after the one before. Every scan goes into all of them; the oldest
/// matures, is registered against the long-term map and dropped, and what it corrects holds from
/// that moment on: the younger maps move with the robot. Level or not makes no difference: heights
/// are taken as they are.
///
/// Use: after each reading that moved the robot, `move`; each scan, `take_scan`; then `localize`,
/// and when its answer is accepted hand T_site_robot and covariance to DeadReckoning::correct
/// before the next reading. Pure and not thread-safe. At most overlapping_maps + 1 maps are held.
class ContinuousLocalization {
 public:
  explicit ContinuousLocalization(const ContinuousConfig& config);

  /// The robot as dead reckoning has it now, earlier corrections included. Not finite: ignored.
  void move(const Pose& T_site_robot);
  /// A scan, and the robot at its time: where it moved to, with a height and an incline that may be
  /// better known. `incline_sigma_rad`: of its roll and pitch.
  void take_scan(const Scan& scan, const LaserSpec& laser, const Pose& T_site_robot,
                 double incline_sigma_rad);

  /// Whether the oldest map is mature: `localize` will register it.
  [[nodiscard]] bool mature() const;
  /// Registers the oldest map if it is mature. `covariance` is dead reckoning's, of (x, y, z, yaw).
  /// An accepted answer is expected to be applied.
  std::optional<Registration> localize(const HeightMap& long_term,
                                       const Eigen::Matrix4d& covariance);

  [[nodiscard]] LocalizationState state() const { return state_; }
  [[nodiscard]] int refusals() const { return refusals_; }
  [[nodiscard]] std::size_t maps() const { return maps_.size(); }
  /// For drawing: the oldest map and its frame; null while there is none.
  [[nodiscard]] const HeightMap* oldest_map() const {
    return maps_.empty() ? nullptr : &maps_.front().surface;
  }

 private:
  struct ShortTermMap {
    HeightMap surface;
    Pose T_site_submap;
    double begun_at = 0.0;  ///< In `progress_`.
    std::size_t scans = 0;
    double incline_rad2 = 0.0;  ///< Sum over the scans of the incline's variance.
  };
  /// A correction that is not yet believed.
  struct Pending {
    Eigen::Isometry3d T_corrected_site;  ///< From where the robot believes it is.
    Eigen::Matrix4d covariance;
    double seen_until = 0.0;  ///< In `progress_`: maps begun later share no scan with it.
  };

  void begin_map();
  [[nodiscard]] Registration register_map_of(const ShortTermMap& map, const HeightMap& long_term,
                                             const Eigen::Matrix4d& covariance) const;
  void judge(const ShortTermMap& map, Registration& answer);
  [[nodiscard]] bool agrees(const Pending& pending, const Registration& answer) const;
  void refuse(const Registration& answer);
  void apply(const Registration& answer);

  ContinuousConfig config_;
  ScanIntegrator integrator_;
  std::deque<ShortTermMap> maps_;  ///< The oldest first.
  Pose T_site_robot_;
  bool placed_ = false;
  double progress_ = 0.0;  ///< In maturities: 1 is the life of a map.
  std::uint32_t begun_ = 0;
  std::optional<Pending> pending_;
  int refusals_ = 0;
  LocalizationState state_ = LocalizationState::localized;
};

}  // namespace cairn
