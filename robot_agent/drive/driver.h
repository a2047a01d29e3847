#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/common/time.h"
#include "core/localization/continuous.h"
#include "core/map/traversability.h"
#include "core/pose/pose.h"
#include "proto/codec/records.h"
#include "proto/sync/robot_link.h"
#include "robot_agent/drive/detour.h"
#include "robot_agent/drive/escape.h"
#include "robot_agent/drive/field_watch.h"
#include "robot_agent/drive/footprint.h"
#include "robot_agent/drive/local_view.h"
#include "robot_agent/drive/path_follower.h"
#include "robot_agent/drive/stall.h"
#include "robot_agent/drive/track.h"

namespace cairn::agent {

struct DriverConfig {
  FollowerConfig follower;
  VehicleLimits limits;
  Footprint footprint;
  Braking braking;
  /// [m] Around its middle the robot itself insists on this much less room than the server plans
  /// with, so that noise in a cell at the rim does not stop it.
  double margin_m = 0.1;
  double arrive_m = 0.025;  ///< [m] Nearer to the end than this is arrived.
  /// [rad] Nearer to the goal's heading than this is arrived, if the goal has one. Below the 3°
  /// that are promised: a robot rolls on a little.
  double arrive_rad = 0.035;
  double look_m = 2.2;         ///< [m] How far ahead the way is judged.
  double stop_short_m = 0.45;  ///< [m] Distance kept from what closes the way.
  /// [m] Within it of unseen ground the robot creeps at `unknown_speed_m_s`.
  double cautious_m = 1.0;
  /// [m/m] An unseen stretch that can be looked at from nowhere is crossed, creeping, when ground
  /// has been seen on both sides and rises or falls no more than this along it. What else cannot be
  /// seen may be a drop.
  double crossable_slope = 0.25;
  double unknown_speed_m_s = 0.25;  ///< [m/s] Where some ground ahead is unseen.
  double max_tilt_rad = 0.45;       ///< [rad] Beyond it the robot stops.
  /// [m] Nearer than this ahead the tilted laser cannot see the ground: to see what was hidden
  /// until now the robot backs up until it is this far away.
  double blind_m = 1.7;
  double backing_speed_m_s = 0.2;
  double unsure_speed_m_s = 0.25;  ///< [m/s] While the robot is not sure where it is.
  double look_around_rad_s = 0.5;  ///< [rad/s] A lost robot turns on the spot this fast.
  double room_behind_m = 0.5;      ///< [m] Known, open ground that backing up needs.
  /// For one path. A robot that is closed in again and again leaves it to the server.
  int most_detours = 20;
  /// For one command.
  int most_escapes = 4;
  /// After so long a silence of the server the robot plans all the way to the goal by itself.
  Duration alone_after = std::chrono::seconds(3);
};

/// Carries out commands: one at a time, newest wins. Stops by itself when the command expires, when
/// the link is silent for too long (if the command says so: there, or back along its track until
/// the server is heard again) and when the robot tilts. Where the way is closed for more than a
/// moment it goes around, on its own map: it picks up the order's field where that leads, or else
/// its path; where it finds no way around it waits for the server's next path; closed in, it backs
/// out along its track, and so it does where something holds it that it does not see. Whatever it
/// follows, its footprint gets over no obstacle of its map. A robot that is not sure where it is
/// drives slowly; a lost one does not drive, it looks around.
class Driver {
 public:
  explicit Driver(const DriverConfig& config) : config_(config) {}

  /// A command from the server. `clock` is the robot's own.
  void take(const proto::RobotLink::Order& order, const Pose& pose, MonotonicTime clock);

  /// Directions of the field around the way of a command.
  void take(const proto::CorridorPart& corridor, int cell_size_mm) {
    field_.take(corridor, cell_size_mm);
  }

  /// How sure the robot is of where it is, and what that rests on.
  void set_localization(LocalizationState state, const std::string& why);

  /// What the wheels shall do now. `silence`: time since the server was last heard.
  DriveCommand step(const Pose& pose, const CellLookup& cells, int cell_size_mm,
                    std::uint8_t min_probability, MonotonicTime clock,
                    std::optional<Duration> silence);

  /// What became of commands since this was last asked.
  [[nodiscard]] std::vector<proto::CommandReport> take_reports();
  /// What the server should be asked for, once each.
  [[nodiscard]] std::optional<proto::CorridorRequest> take_request() {
    return field_.take_request();
  }

  [[nodiscard]] proto::DriveState state() const { return state_; }
  [[nodiscard]] std::uint64_t command() const { return busy() ? command_.id : 0; }
  [[nodiscard]] double to_go_m() const { return follower_ && busy() ? follower_->to_go_m() : 0.0; }
  [[nodiscard]] bool busy() const {
    return state_ == proto::DriveState::driving || state_ == proto::DriveState::blocked;
  }

 private:
  void take_stop(const proto::Command& command);
  void take_goal(const proto::RobotLink::Order& order, const Pose& pose, MonotonicTime clock);
  void end(proto::CommandState how, std::string why);
  void report(proto::CommandState state, std::string why);
  void block(std::string why, MonotonicTime clock);
  /// What a silent link asks for; true when the command has ended by it.
  bool mind_link(const Pose& pose, Duration silence);
  [[nodiscard]] std::optional<std::string> reason_to_end(const Pose& pose, MonotonicTime clock,
                                                         std::optional<Duration> silence);
  /// Does not get on though it is told to: backs out, whatever its map says.
  void mind_stall(const Pose& pose, MonotonicTime clock);
  [[nodiscard]] bool must_back_out(const Pose& pose, const OwnMap& map) const;
  DriveCommand follow(const Pose& pose, const OwnMap& map, MonotonicTime clock,
                      std::optional<Duration> silence);
  [[nodiscard]] std::vector<Eigen::Vector2d> with_room_at_end(
      std::vector<Eigen::Vector2d> way_m) const;
  /// Before an unseen stretch: turns to it, backs up to look at it; nullopt when it must go around
  /// it or, as `crossable` says, may creep over it.
  std::optional<DriveCommand> look_into_gap(const Pose& pose, const LocalView& view,
                                            const Gap& gap);
  [[nodiscard]] bool crossable(const Gap& gap) const {
    return gap.rise_m <= config_.crossable_slope * gap.length_m;
  }
  /// The way is closed `clear_m` ahead: waits a moment, then goes around, or else reports `why`.
  void wait_or_go_around(const std::string& why, double clear_m, const Pose& pose,
                         const OwnMap& map, MonotonicTime clock, std::optional<Duration> silence);
  /// What lies around it, by the limits that the server plans with.
  [[nodiscard]] LocalView room_around(const Pose& pose, const OwnMap& map) const;
  /// Closed in, it backs out along the track until there is room; false when it is not, or tried
  /// that enough.
  bool escape(const Pose& pose, const OwnMap& map);
  std::optional<DriveCommand> go_on_escaping(const Pose& pose, const OwnMap& map);
  /// The command, or slower, so that nothing gets under the robot; nullopt when even that does.
  [[nodiscard]] std::optional<DriveCommand> with_room(const DriveCommand& command, const Pose& pose,
                                                      const OwnMap& map) const;
  bool go_around(double clear_m, const Pose& pose, const OwnMap& map, bool alone);
  /// Leaves the path and picks the field up elsewhere.
  bool pick_up(const Pose& pose, const OwnMap& map);
  void set_way(std::vector<Eigen::Vector2d> way_m, const Pose& pose);
  /// What the robot itself insists on: `margin_m` less room than the server plans with.
  [[nodiscard]] VehicleLimits own_limits() const;
  /// [m/s] Slow enough to stop before what is closed, on unseen ground, and while unsure.
  [[nodiscard]] double speed_limit_m_s(const Ahead& ahead) const;
  /// Lost: turns on the spot to see what is around, a few turns; then gives up.
  DriveCommand look_around(const Pose& pose);
  DriveCommand back_up(const Pose& pose, const LocalView& view);
  /// At the path's end: turns to the goal's heading, then says that it has arrived.
  DriveCommand turn_to_heading(const Pose& pose);
  void arrive();

  DriverConfig config_;
  proto::DriveState state_ = proto::DriveState::idle;
  proto::Command command_;
  std::optional<PathFollower> follower_;
  bool way_cut_ = false;  ///< What is driven along ends early: there is more to ask for.
  bool at_end_ = false;   ///< The path's end was reached: it turns to the goal's heading.
  FieldWatch field_;
  Track track_;
  /// [m] What lay before the robot when it turned back for the link's sake; only while it does.
  std::optional<double> way_back_m_;
  MonotonicTime blocked_since_{};
  bool blocked_reported_ = false;
  std::optional<Eigen::Vector2d> backing_from_m_;  ///< Where it began to back up, if it does.
  double backing_m_ = 0.0;                         ///< How far it wants to.
  LocalizationState localization_ = LocalizationState::localized;
  std::string localization_why_;
  std::optional<double> last_yaw_rad_;  ///< While looking around.
  double looked_around_rad_ = 0.0;      ///< Since the robot was lost.
  std::optional<Escape> escape_;        ///< While it backs out.
  Stall stall_;
  DriveCommand told_;                          ///< What the wheels were told last.
  std::optional<Eigen::Vector2d> held_at_m_;   ///< While it backs out from where it was held.
  int escapes_ = 0;                            ///< For this command.
  int times_backed_up_ = 0;                    ///< For this command.
  int detours_ = 0;                            ///< From this path.
  std::vector<proto::CommandReport> reports_;  ///< Bounded: emptied at every step.
};

}  // namespace cairn::agent
