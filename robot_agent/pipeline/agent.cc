#include "robot_agent/pipeline/agent.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

namespace cairn::agent {

namespace {

std::int32_t to_mm(double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); }

template <class Int>
Int saturated(double value) {
  return static_cast<Int>(std::clamp(std::round(value),
                                     static_cast<double>(std::numeric_limits<Int>::min()),
                                     static_cast<double>(std::numeric_limits<Int>::max())));
}

std::uint64_t to_ms(MonotonicTime time) {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(time).count());
}

proto::Localization to_wire(LocalizationState state) {
  if (state == LocalizationState::localized) return proto::Localization::localized;
  return state == LocalizationState::unsure ? proto::Localization::unsure
                                            : proto::Localization::lost;
}

bool is_end(proto::CommandState state) {
  return state != proto::CommandState::accepted && state != proto::CommandState::blocked;
}

}  // namespace

Agent::Agent(const AgentConfig& config, Input& input, proto::Carrier& carrier, Spool* spool)
    : config_(config),
      input_(input),
      carrier_(carrier),
      link_(config.link, carrier.overhead_bytes()),
      spool_(spool),
      mapper_(config.mapper, input.lasers(), input.start(), config.link.boot, link_.evidence()),
      driver_(config.driver) {}

Status Agent::step(MonotonicTime until, MonotonicTime clock) {
  Result<std::vector<Reading>> readings = input_.advance(until);
  if (!readings) return readings.error();
  for (const Reading& reading : *readings) take_reading(reading);
  drive(clock);
  tell(clock);
  return {};
}

void Agent::take_reading(const Reading& reading) {
  if (const auto* motion = std::get_if<MotionReading>(&reading)) mapper_.take_motion(*motion);
  if (const auto* scan = std::get_if<Scan>(&reading)) mapper_.take_scan(*scan);
}

void Agent::drive(MonotonicTime clock) {
  driver_.set_localization(mapper_.localization(), mapper_.localization_why());
  const auto cells = [this](CellIndex cell) { return mapper_.cell(cell); };
  wheels_ = driver_.step(mapper_.pose(), cells, mapper_.cell_size_mm(),
                         mapper_.sensor_model().min_probability, clock, link_.silence(clock));
  input_.drive(wheels_);
}

void Agent::tell(MonotonicTime clock) {
  for (const proto::CommandReport& report : driver_.take_reports()) {
    link_.report(report);
    if (is_end(report.state)) journey_ = Journey{report, mapper_.pose(), input_.truth()};
  }
  if (const auto request = driver_.take_request()) link_.request(*request);
  const Pose& pose = mapper_.pose();
  proto::PoseReport report;
  report.clock_ms = to_ms(clock);
  report.T_site_robot = {to_mm(pose.x_m), to_mm(pose.y_m), to_mm(pose.z_m),
                         static_cast<std::int32_t>(std::lround(pose.yaw_rad * 1e4))};
  report.roll_1e4rad = saturated<std::int16_t>(pose.roll_rad * 1e4);
  report.pitch_1e4rad = saturated<std::int16_t>(pose.pitch_rad * 1e4);
  report.sigma_mm = saturated<std::uint16_t>(mapper_.position_sigma_m() * 1000.0);
  report.speed_mm_s = saturated<std::int16_t>(wheels_.speed_m_s * 1000.0);
  report.drive = driver_.state();
  report.localization = to_wire(mapper_.localization());
  report.command = driver_.command();
  report.to_go_mm = saturated<std::uint32_t>(driver_.to_go_m() * 1000.0);
  report.backlog_blocks = static_cast<std::uint32_t>(link_.evidence().backlog_blocks());
  link_.set_pose(report);
}

Status Agent::send_due(MonotonicTime clock) {
  while (auto bytes = link_.next_frame(clock)) {
    Status sent = carrier_.send({{}, std::move(*bytes)});
    // A server that is not in reach yet is what the link's timers are for.
    if (!sent && sent.error().code != ErrorCode::unavailable) return sent;
  }
  return {};
}

Status Agent::exchange(MonotonicTime clock, std::chrono::milliseconds wait) {
  if (Status sent = send_due(clock); !sent) return sent;
  for (auto timeout = wait;; timeout = std::chrono::milliseconds(0)) {
    Result<std::optional<proto::Datagram>> received = carrier_.receive(timeout);
    if (!received) return received.error();
    if (!received->has_value()) break;
    for (const proto::RobotLink::Order& order : link_.on_frame((*received)->bytes, clock)) {
      if (input_.can_drive()) {
        driver_.take(order, mapper_.pose(), clock);
      } else {
        link_.report({order.command.id, order.command.revision, proto::CommandState::refused,
                      "this robot replays a log and cannot drive"});
      }
    }
  }
  for (const proto::CorridorPart& corridor : link_.take_corridors()) {
    driver_.take(corridor, mapper_.cell_size_mm());
    ++corridors_;
  }
  take_map();
  compare_maps(clock);
  if (spool_ != nullptr) {
    spool_->look(link_.evidence(), clock);
    link_.set_spool(spool_->report());
  }
  return send_due(clock);
}

bool Agent::delivered() const {
  return link_.evidence().synchronised() && (spool_ == nullptr || spool_->all_taken_up());
}

bool Agent::keep_the_rest(MonotonicTime clock) {
  constexpr std::chrono::seconds kPatience(5);
  return spool_ == nullptr || spool_->flush(link_.evidence(), clock, kPatience);
}

void Agent::take_map() {
  for (const proto::MapUpdate& update : link_.take_map_updates()) {
    link_.evidence().set_edition(update.edition);
    std::vector<GivenTile> tiles;
    for (const auto& [key, tile, holds] : update.tiles) tiles.push_back({key, tile, holds});
    std::vector<std::pair<std::uint32_t, SubmapPose>> moves;
    for (const auto& [sequence, pose] : update.moves) moves.emplace_back(sequence, pose);
    mapper_.move_submaps(moves);
    mapper_.take_tiles(tiles);
  }
}

void Agent::compare_maps(MonotonicTime clock) {
  constexpr std::size_t kSome = 5;  // A parked robot stays below 100 bit/s.
  const proto::RobotLink::DigestWish wish = link_.digest_wish(clock);
  if (wish == proto::RobotLink::DigestWish::none) return;
  auto digests = mapper_.replica().digests(link_.evidence().held_up_to());
  if (wish == proto::RobotLink::DigestWish::all) {
    if (!digests.empty()) digests.back().last = true;
  } else if (digests.size() > kSome) {
    next_digest_ = (next_digest_ + kSome) % digests.size();
    std::rotate(digests.begin(), digests.begin() + static_cast<std::ptrdiff_t>(next_digest_),
                digests.end());
    digests.resize(kSome);
  }
  link_.tell_digests(std::move(digests), clock);
}

void Agent::say_goodbye() {
  if (auto bytes = link_.goodbye()) (void)carrier_.send({{}, std::move(*bytes)});
}

bool Agent::congested() const {
  return link_.evidence().backlog_blocks() > config_.replay_backlog_blocks;
}

}  // namespace cairn::agent
