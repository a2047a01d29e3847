#include "robot_agent/drive/driver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "core/common/angle.h"
#include "robot_agent/drive/pick_up.h"

namespace cairn::agent {

namespace {

using proto::CommandState;
using proto::DriveState;

/// A way that is closed for less than this is not worth a new plan.
constexpr Duration kBlockedPatience = std::chrono::milliseconds(400);
/// While blocked the server is told again this often, so that it tries again.
constexpr Duration kBlockedRepeat = std::chrono::seconds(3);
/// A command is worth this many looks from further back.
constexpr int kMaxBackups = 6;
/// A place must be found twice, by maps of a turn each, and the first may have been cut short.
constexpr double kTurnsToLookAround = 3.0;
/// [m] A path that begins further away was made for somewhere else.
constexpr double kMaxOffPathM = 1.5;
/// [m] So far it backs out from what holds it.
constexpr double kLeaveHeldM = 0.3;
/// [m] Further than it drives before it stands.
constexpr double kRoomM = 1.5;
/// While it turns at the end of its path it may be this many times as far off as when it came.
constexpr double kDriftAtEnd = 3.0;

std::string in_metres(const char* text, double distance_m) {
  char line[96];
  std::snprintf(line, sizeof line, text, distance_m);
  return line;
}

std::uint64_t to_ms(MonotonicTime time) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(time).count());
}

}  // namespace

void Driver::take(const proto::RobotLink::Order& order, const Pose& pose, MonotonicTime clock) {
  if (order.command.kind == proto::CommandKind::stop) {
    take_stop(order.command);
  } else {
    take_goal(order, pose, clock);
  }
}

void Driver::take_stop(const proto::Command& command) {
  if (busy() && command.id != command_.id) {
    end(CommandState::superseded, "stopped by " + command.issuer);
  }
  command_ = command;
  follower_.reset();
  end(CommandState::stopped, "");
}

void Driver::take_goal(const proto::RobotLink::Order& order, const Pose& pose,
                       MonotonicTime clock) {
  if (busy() && order.command.id != command_.id) {
    end(CommandState::superseded, "a newer goal came from " + order.command.issuer);
  }
  if (order.command.id !=
      command_.id) {  // A new path for the same goal goes on with its manoeuvre.
    times_backed_up_ = 0;
    backing_from_m_.reset();
    escapes_ = 0;
    escape_.reset();
    held_at_m_.reset();
  }
  command_ = order.command;
  if (to_ms(clock) >= command_.expires_clock_ms) {
    return end(CommandState::expired, "it was already too old when it came");
  }
  if (order.path.empty()) return end(CommandState::refused, "it has no path");
  auto path = read_path(command_, order.path);
  if (!path) return end(CommandState::refused, path.error().message);
  way_cut_ = command_.path_cut;
  follower_.emplace(config_.follower, path->points_m);
  field_.begin(command_, *std::move(path));
  way_back_m_.reset();
  at_end_ = false;
  state_ = DriveState::driving;
  blocked_since_ = {};
  blocked_reported_ = false;
  detours_ = 0;
  report(CommandState::accepted, "");
  follower_->advance({pose.x_m, pose.y_m});
}

void Driver::report(CommandState state, std::string why) {
  reports_.push_back({command_.id, command_.revision, state, std::move(why)});
}

void Driver::end(CommandState how, std::string why) {
  state_ = how == CommandState::arrived ? DriveState::idle : DriveState::stopped;
  report(how, std::move(why));
}

std::vector<proto::CommandReport> Driver::take_reports() { return std::exchange(reports_, {}); }

bool Driver::mind_link(const Pose& pose, Duration silence) {
  const bool lost = silence > std::chrono::milliseconds(command_.link_timeout_ms);
  if (way_back_m_ && !lost) {
    end(CommandState::stopped,
        in_metres("the link was lost: came back %.1f m", *way_back_m_ - follower_->to_go_m()));
    return true;
  }
  if (!lost || way_back_m_ || command_.on_link_loss == proto::OnLinkLoss::proceed) return false;
  if (command_.on_link_loss == proto::OnLinkLoss::stop) {
    end(CommandState::stopped, in_metres("the link was silent for %.1f s", to_seconds(silence)));
    return true;
  }
  follower_.emplace(config_.follower, track_.back_from({pose.x_m, pose.y_m}));
  way_back_m_ = follower_->to_go_m();
  return false;
}

std::optional<std::string> Driver::reason_to_end(const Pose& pose, MonotonicTime clock,
                                                 std::optional<Duration> silence) {
  if (to_ms(clock) >= command_.expires_clock_ms) {
    end(CommandState::expired, "its time was over before the goal was reached");
    return reports_.back().why;
  }
  if (mind_link(pose, silence.value_or(Duration{}))) return reports_.back().why;
  if (std::max(std::abs(pose.roll_rad), std::abs(pose.pitch_rad)) > config_.max_tilt_rad) {
    end(CommandState::stopped, "the ground is too steep here");
    return reports_.back().why;
  }
  return std::nullopt;
}

DriveCommand Driver::step(const Pose& pose, const CellLookup& cells, int cell_size_mm,
                          std::uint8_t min_probability, MonotonicTime clock,
                          std::optional<Duration> silence) {
  track_.add({pose.x_m, pose.y_m});
  if (!busy() || reason_to_end(pose, clock, silence)) return told_ = {};
  if (localization_ == LocalizationState::lost) return told_ = look_around(pose);
  mind_stall(pose, clock);
  return told_ = follow(pose, {cells, cell_size_mm, min_probability}, clock, silence);
}

void Driver::mind_stall(const Pose& pose, MonotonicTime clock) {
  if (!stall_.step(pose, told_, clock) || escapes_ >= config_.most_escapes) return;
  ++escapes_;
  held_at_m_ = Eigen::Vector2d(pose.x_m, pose.y_m);
  escape_.emplace(config_.follower, track_, *held_at_m_, config_.backing_speed_m_s);
  report(CommandState::blocked, "something holds it that it does not see: it backs out");
}

void Driver::set_localization(LocalizationState state, const std::string& why) {
  if (state != LocalizationState::lost) {
    looked_around_rad_ = 0.0;
    last_yaw_rad_.reset();
  }
  localization_ = state;
  localization_why_ = why;
}

DriveCommand Driver::look_around(const Pose& pose) {
  looked_around_rad_ += std::abs(wrap_angle(pose.yaw_rad - last_yaw_rad_.value_or(pose.yaw_rad)));
  last_yaw_rad_ = pose.yaw_rad;
  if (looked_around_rad_ > kTurnsToLookAround * 2.0 * std::numbers::pi) {
    end(CommandState::stopped, "lost: " + localization_why_);
    return {};
  }
  state_ = DriveState::blocked;  // Not reported: another path would not help.
  return {0.0, config_.look_around_rad_s};
}

DriveCommand Driver::turn_to_heading(const Pose& pose) {
  const double left_rad =
      command_.goal_yaw_1e4rad ? wrap_angle(*command_.goal_yaw_1e4rad * 1e-4 - pose.yaw_rad) : 0.0;
  if (std::abs(left_rad) <= config_.arrive_rad) {
    arrive();
    return {};
  }
  state_ = DriveState::driving;
  return {0.0, turn_on_the_spot_rad_s(config_.follower, left_rad)};
}

void Driver::arrive() {
  const Eigen::Vector2d goal_m(command_.goal_x_mm / 1000.0, command_.goal_y_mm / 1000.0);
  const double short_m = (goal_m - follower_->end_m()).norm();
  if (short_m <= config_.arrive_m) return end(CommandState::arrived, "");
  end(CommandState::arrived,
      in_metres("the nearest place in reach, %.1f m from the goal", short_m));
}

DriveCommand Driver::follow(const Pose& pose, const OwnMap& map, MonotonicTime clock,
                            std::optional<Duration> silence) {
  const Eigen::Vector2d place_m(pose.x_m, pose.y_m);
  follower_->advance(place_m);
  // Turning on the spot may shift it a little, or what it knows of its place.
  const double near_m = at_end_ ? kDriftAtEnd * config_.arrive_m : config_.arrive_m;
  at_end_ = (follower_->end_m() - place_m).norm() <= near_m;
  if (at_end_) {
    if (way_back_m_) {
      end(CommandState::stopped, "the link was lost: came back all the way");
    } else if (!way_cut_) {
      return turn_to_heading(pose);
    } else {
      block("the path ends here: the rest, please", clock);
    }
    return {};
  }
  if (follower_->off_path_m() > kMaxOffPathM) {
    block(in_metres("the path is %.1f m away", follower_->off_path_m()), clock);
    return {};
  }
  const LocalView view(map.cells, map.cell_size_mm, map.min_probability, place_m,
                       config_.look_m + 1.0, own_limits());
  if (backing_from_m_) {
    field_.pause();
    if (const DriveCommand backing = back_up(pose, view); backing.speed_m_s < 0.0) return backing;
    backing_from_m_.reset();
  }
  if (const auto command = go_on_escaping(pose, map)) {
    field_.pause();
    return *command;
  }
  std::vector<Eigen::Vector2d> way = follower_->ahead();
  way.insert(way.begin(), place_m);
  const Ahead ahead = view.look_along(with_room_at_end(way), config_.look_m);
  if (ahead.clear_m < std::min(config_.stop_short_m, follower_->to_go_m())) {
    wait_or_go_around(in_metres("something closes the way %.1f m ahead", ahead.clear_m),
                      ahead.clear_m, pose, map, clock, silence);
    return {};
  }
  if (ahead.gap && ahead.gap->from_m < config_.stop_short_m) {
    if (const auto command = look_into_gap(pose, view, *ahead.gap)) return *command;
    if (!crossable(*ahead.gap)) {
      wait_or_go_around("the ground ahead cannot be seen: it may be a drop", ahead.gap->from_m,
                        pose, map, clock, silence);
      return {};
    }
  }
  const double limit_m_s = speed_limit_m_s(ahead);
  auto command = with_room(follower_->steer(pose, limit_m_s), pose, map);
  if (!command) command = with_room(follower_->steer_closely(pose, limit_m_s), pose, map);
  if (!command) {
    wait_or_go_around("there is no room to drive on here", config_.stop_short_m, pose, map, clock,
                      silence);
    return {};
  }
  if (!way_back_m_) field_.look(way, map.cell_size_mm, clock);
  state_ = DriveState::driving;
  blocked_since_ = {};
  blocked_reported_ = false;
  return *command;
}

/// The way as far as the vehicle's front will get on it.
std::vector<Eigen::Vector2d> Driver::with_room_at_end(std::vector<Eigen::Vector2d> way_m) const {
  if (way_m.size() < 2) return way_m;
  const Eigen::Vector2d last = way_m.back() - way_m[way_m.size() - 2];
  if (last.norm() > 0.0)
    way_m.emplace_back(way_m.back() + config_.stop_short_m * last.normalized());
  return way_m;
}

std::optional<DriveCommand> Driver::with_room(const DriveCommand& command, const Pose& pose,
                                              const OwnMap& map) const {
  const LocalView room = room_around(pose, map);
  for (const double share : {1.0, 0.5, 0.2}) {
    const DriveCommand slower{share * command.speed_m_s, share * command.turn_rate_rad_s};
    if (!runs_into(room, config_.footprint, config_.braking, pose, slower)) return slower;
  }
  return std::nullopt;
}

LocalView Driver::room_around(const Pose& pose, const OwnMap& map) const {
  return {map.cells,
          map.cell_size_mm,
          map.min_probability,
          {pose.x_m, pose.y_m},
          config_.limits.radius_m + kRoomM,
          config_.limits};
}

bool Driver::escape(const Pose& pose, const OwnMap& map) {
  if (escapes_ >= config_.most_escapes || room_around(pose, map).open_at({pose.x_m, pose.y_m}))
    return false;
  ++escapes_;
  escape_.emplace(config_.follower, track_, Eigen::Vector2d(pose.x_m, pose.y_m),
                  config_.backing_speed_m_s);
  return true;
}

std::optional<DriveCommand> Driver::go_on_escaping(const Pose& pose, const OwnMap& map) {
  if (!escape_) return std::nullopt;
  if (must_back_out(pose, map)) {
    // Where it has just driven nothing is in the way, whatever the map says of the ground there.
    if (const auto back = escape_->step(pose)) return back;
  }
  escape_.reset();
  held_at_m_.reset();
  return std::nullopt;
}

bool Driver::must_back_out(const Pose& pose, const OwnMap& map) const {
  const Eigen::Vector2d place_m(pose.x_m, pose.y_m);
  const bool held = held_at_m_ && (place_m - *held_at_m_).norm() < kLeaveHeldM;
  return held || !room_around(pose, map).open_at(place_m);
}

double Driver::speed_limit_m_s(const Ahead& ahead) const {
  double limit_m_s = std::sqrt(2.0 * config_.follower.deceleration_m_s2 *
                               std::max(0.0, ahead.clear_m - config_.stop_short_m * 0.5));
  if (ahead.known_m < config_.cautious_m)
    limit_m_s = std::min(limit_m_s, config_.unknown_speed_m_s);
  if (localization_ == LocalizationState::unsure) {
    limit_m_s = std::min(limit_m_s, config_.unsure_speed_m_s);
  }
  return std::max(limit_m_s, config_.follower.creep_m_s);
}

std::optional<DriveCommand> Driver::look_into_gap(const Pose& pose, const LocalView& view,
                                                  const Gap& gap) {
  const DriveCommand turning = follower_->steer(pose, 0.0);
  if (turning.turn_rate_rad_s != 0.0) return turning;  // Look there first.
  if (times_backed_up_ < kMaxBackups) {
    ++times_backed_up_;
    backing_from_m_ = Eigen::Vector2d(pose.x_m, pose.y_m);
    backing_m_ = config_.blind_m - gap.from_m;
    if (const DriveCommand backing = back_up(pose, view); backing.speed_m_s < 0.0) return backing;
    backing_from_m_.reset();
  }
  return std::nullopt;
}

DriveCommand Driver::back_up(const Pose& pose, const LocalView& view) {
  const Eigen::Vector2d place_m(pose.x_m, pose.y_m);
  if ((place_m - *backing_from_m_).norm() >= backing_m_) return {};
  const Eigen::Vector2d behind_m =
      place_m -
      config_.room_behind_m * Eigen::Vector2d(std::cos(pose.yaw_rad), std::sin(pose.yaw_rad));
  const Ahead behind = view.look_along({place_m, behind_m}, config_.room_behind_m);
  if (behind.clear_m < config_.room_behind_m || behind.known_m < config_.room_behind_m) return {};
  state_ = DriveState::driving;
  return {-config_.backing_speed_m_s, 0.0};
}

void Driver::wait_or_go_around(const std::string& why, double clear_m, const Pose& pose,
                               const OwnMap& map, MonotonicTime clock,
                               std::optional<Duration> silence) {
  const Duration patience = blocked_reported_ ? kBlockedRepeat : kBlockedPatience;
  const bool for_long = blocked_since_ != MonotonicTime{} && clock - blocked_since_ >= patience;
  const bool alone = !silence || *silence > config_.alone_after;
  if (for_long && (go_around(clear_m, pose, map, alone) || escape(pose, map))) return;
  if (for_long && !way_back_m_) field_.closed_in({pose.x_m, pose.y_m}, clock);
  block(why, clock);
}

bool Driver::go_around(double clear_m, const Pose& pose, const OwnMap& map, bool alone) {
  if (detours_ >= config_.most_detours) return false;
  if (!way_back_m_ && pick_up(pose, map)) return true;
  const Eigen::Vector2d place_m(pose.x_m, pose.y_m);
  std::vector<DetourReach> reaches{DetourReach::near};
  if (alone) reaches.push_back(DetourReach::far);
  for (const DetourReach reach : reaches) {
    for (const VehicleLimits& limits : {config_.limits, own_limits()}) {
      auto way_m = way_around(map, limits, place_m, follower_->ahead(), clear_m, reach);
      if (!way_m) continue;
      set_way(*std::move(way_m), pose);
      return true;
    }
  }
  return false;
}

bool Driver::pick_up(const Pose& pose, const OwnMap& map) {
  for (const VehicleLimits& limits : {config_.limits, own_limits()}) {
    auto picked = pick_up_field(map, limits, {pose.x_m, pose.y_m}, field_.corridor());
    if (!picked) continue;
    set_way(std::move(picked->way_m), pose);
    way_cut_ = !picked->to_goal;
    return true;
  }
  return false;
}

void Driver::set_way(std::vector<Eigen::Vector2d> way_m, const Pose& pose) {
  ++detours_;
  follower_.emplace(config_.follower, std::move(way_m));
  follower_->advance({pose.x_m, pose.y_m});
  state_ = DriveState::driving;
  blocked_since_ = {};
}

VehicleLimits Driver::own_limits() const {
  VehicleLimits limits = config_.limits;
  limits.radius_m = std::max(0.0, limits.radius_m - config_.margin_m);
  return limits;
}

void Driver::block(std::string why, MonotonicTime clock) {
  state_ = DriveState::blocked;
  if (blocked_since_ == MonotonicTime{}) blocked_since_ = clock;
  const Duration patience = blocked_reported_ ? kBlockedRepeat : kBlockedPatience;
  if (clock - blocked_since_ < patience) return;
  blocked_since_ = clock;
  blocked_reported_ = true;
  report(CommandState::blocked, std::move(why));
}

}  // namespace cairn::agent
