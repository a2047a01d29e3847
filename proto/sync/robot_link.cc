#include "proto/sync/robot_link.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "proto/sync/rejection.h"

namespace cairn::proto {
namespace {

std::uint64_t to_clock_ms(MonotonicTime now) {
  assert(now.count() >= 0);
  return static_cast<std::uint64_t>(now.count() / 1000);
}

bool holds_order(const Frame& frame) {
  return std::ranges::any_of(frame.records, [](const Record& record) {
    return std::holds_alternative<Command>(record) || std::holds_alternative<PathPart>(record);
  });
}

bool holds_map(const Frame& frame) {
  return std::ranges::any_of(frame.records, [](const Record& record) {
    return std::holds_alternative<MapPatch>(record) || std::holds_alternative<SubmapMove>(record) ||
           std::holds_alternative<MapCommit>(record) ||
           std::holds_alternative<CorridorPart>(record);
  });
}

bool further_than(std::int32_t a, std::int32_t b, std::int64_t limit) {
  return std::abs(std::int64_t{a} - b) > limit;
}

/// Whether the server would learn something from `next` that it cannot take from `told`.
bool tells_more(const PoseReport& told, const PoseReport& next) {
  constexpr std::int64_t kStillMm = 20;
  constexpr std::int64_t kStill1e4rad = 100;
  const SubmapPose& a = told.T_site_robot;
  const SubmapPose& b = next.T_site_robot;
  return further_than(a.x_mm, b.x_mm, kStillMm) || further_than(a.y_mm, b.y_mm, kStillMm) ||
         further_than(a.z_mm, b.z_mm, kStillMm) ||
         further_than(a.yaw_1e4rad, b.yaw_1e4rad, kStill1e4rad) || next.speed_mm_s != 0 ||
         told.drive != next.drive || told.localization != next.localization ||
         told.command != next.command || (told.backlog_blocks == 0) != (next.backlog_blocks == 0);
}

}  // namespace

RobotLink::RobotLink(RobotLinkConfig config, std::size_t carrier_overhead_bytes)
    : config_(std::move(config)),
      overhead_bytes_(carrier_overhead_bytes),
      budget_(config_.budget) {}

void RobotLink::set_pose(const PoseReport& pose) { pose_ = pose; }

void RobotLink::report(const CommandReport& report) { reports_.post(report); }

void RobotLink::request(const CorridorRequest& request) { request_ = {.record = request}; }

std::optional<Duration> RobotLink::silence(MonotonicTime now) const {
  if (!heard_at_) return std::nullopt;
  return now - *heard_at_;
}

std::optional<Duration> RobotLink::round_trip() const { return flight_.round_trip().smoothed(); }

// ---- What arrives -------------------------------------------------------------------------------

std::vector<Order> RobotLink::on_frame(std::span<const std::uint8_t> bytes, MonotonicTime now) {
  ++counters_.frames_received;
  counters_.bytes_received += bytes.size() + overhead_bytes_;
  const Result<Frame> frame = decode_frame(bytes, Direction::down);
  if (!frame) {
    ++counters_.frames_malformed;
    return {};
  }
  for (const Record& record : frame->records) on_answer(record, frame->header, now);
  if (session_ == 0 || frame->header.session != session_) return {};
  return on_session_frame(*frame, now);
}

void RobotLink::on_answer(const Record& record, const FrameHeader& header, MonotonicTime now) {
  if (const auto* welcome = std::get_if<Welcome>(&record)) {
    if (welcome->session == header.session) on_welcome(*welcome, now);
  } else if (const auto* reject = std::get_if<Reject>(&record)) {
    on_reject(*reject, now);
  } else if (std::holds_alternative<Reset>(record) && session_ != 0 && header.session == session_) {
    leave_session();
    say_hello_from(now);
  }
}

void RobotLink::on_welcome(const Welcome& welcome, MonotonicTime now) {
  if (welcome.boot != config_.boot) return;
  // Said in a session that stands, it asks whether this robot is still there: a pose says so.
  if (phase_ == Phase::connected && welcome.session == session_) told_.reset();
  if (phase_ != Phase::hello) return;
  // A late answer must not revive a session whose frame numbers were used already.
  if (std::ranges::find(left_sessions_, welcome.session) != left_sessions_.end()) return;
  if (welcome.session == session_) {
    lost(flight_.lose_all());  // The link was away, the session is not.
    budget_.on_return();
  } else {
    begin_session(welcome);
  }
  phase_ = Phase::connected;
  in_use_since_.reset();
  heard_at_ = now;
}

void RobotLink::leave_session() {
  if (session_ == 0) return;
  left_sessions_.push_back(session_);
  if (left_sessions_.size() > kMaxLeftSessions) left_sessions_.pop_front();
  session_ = 0;
}

void RobotLink::begin_session(const Welcome& welcome) {
  leave_session();
  const bool other_store = epoch_ && *epoch_ != welcome.epoch;
  session_ = welcome.session;
  epoch_ = welcome.epoch;
  flight_.reset();
  received_ = {};
  ack_due_.reset();
  map_unacked_ = 0;
  told_.reset();
  spool_told_at_.reset();
  evidence_.on_session(other_store);
  round_open_ = false;
  round_due_ = {};
  reports_.on_session();
  if (request_) request_->transit.again();
  map_.on_session();
  digests_.on_session();
  digests_due_.reset();
  if (other_store) orders_.forget();
}

void RobotLink::on_reject(const Reject& reject, MonotonicTime now) {
  if (phase_ != Phase::hello || reject.boot != config_.boot) return;
  if (reject.reason == RejectReason::robot_id_in_use) {
    if (!in_use_since_) in_use_since_ = now;
    if (now - *in_use_since_ < config_.in_use_patience) return;
  }
  phase_ = Phase::rejected;
  rejected_ = explain(reject, config_.robot, config_.site, config_.cell_size_mm);
}

std::vector<Order> RobotLink::on_session_frame(const Frame& frame, MonotonicTime now) {
  heard_at_ = now;
  unanswered_since_.reset();
  if (phase_ == Phase::hello) {  // It was only silent.
    phase_ = Phase::connected;
    lost(flight_.lose_all());
    budget_.on_return();
  }
  if (holds_order(frame)) acknowledge_by(now + kAckDelay);
  if (holds_map(frame)) {
    acknowledge_by(++map_unacked_ >= kMostMapUnacked ? now : now + kMapAckDelay);
  }
  if (received_.is_done(frame.header.number)) return {};
  if (!take_patches(frame)) {
    ++counters_.frames_malformed;
    return {};
  }
  const bool elicits = holds_order(frame) || holds_map(frame);
  received_.done(frame.header.number, elicits ? std::optional(now) : std::nullopt);
  std::vector<Order> orders;
  for (const Record& record : frame.records) {
    if (const auto* ack = std::get_if<Ack>(&record)) on_ack(*ack, now);
    if (const auto* refusal = std::get_if<Refusal>(&record)) evidence_.on_refused(*refusal);
    if (const auto* lost = std::get_if<GroundLost>(&record)) evidence_.on_ground_lost(*lost);
    if (const auto* command = std::get_if<Command>(&record)) {
      take(orders_.on_command(*command), orders);
    }
    if (const auto* part = std::get_if<PathPart>(&record)) take(orders_.on_part(*part), orders);
    if (const auto* corridor = std::get_if<CorridorPart>(&record)) orders_.on_corridor(*corridor);
    take_map(record);
  }
  return orders;
}

bool RobotLink::take_patches(const Frame& frame) {
  return std::ranges::all_of(frame.records, [&](const Record& record) {
    const auto* patch = std::get_if<MapPatch>(&record);
    return patch == nullptr || map_.on_patch(*patch);
  });
}

void RobotLink::take_map(const Record& record) {
  if (const auto* move = std::get_if<SubmapMove>(&record)) map_.on_move(*move);
  if (const auto* commit = std::get_if<MapCommit>(&record)) {
    if (auto update = map_.on_commit(*commit)) map_updates_.push_back(*std::move(update));
  }
}

std::vector<MapUpdate> RobotLink::take_map_updates() { return std::exchange(map_updates_, {}); }

void RobotLink::acknowledge_by(MonotonicTime due) {
  ack_due_ = ack_due_ ? std::min(*ack_due_, due) : due;
}

void RobotLink::on_ack(const Ack& ack, MonotonicTime now) {
  const Flight::News news = flight_.on_ack(ack, now);
  if (news.round_trip) budget_.on_round_trip(*news.round_trip, news.newest, now);
  budget_.on_fate(news.acked.size(), news.lost.size(), news.found_again);
  counters_.frames_lost -= news.found_again;
  for (const std::uint32_t number : news.acked) {
    evidence_.on_acked(number);
    reports_.on_acked(number);
    digests_.on_acked(number);
    if (request_) request_->transit.on_acked(number);
  }
  if (request_ && request_->transit.acknowledged()) request_.reset();
  lost(news.lost);
}

void RobotLink::take(OrderDesk::Outcome outcome, std::vector<Order>& orders) {
  if (outcome.order) orders.push_back(*std::move(outcome.order));
  if (outcome.asked_again) reports_.ask(outcome.asked_again->first, outcome.asked_again->second);
  if (!outcome.superseded) return;
  const auto [id, revision] = *outcome.superseded;
  const bool said_what_became_of_it = reports_.ask(id, revision);
  if (said_what_became_of_it) return;
  reports_.post({id, revision, CommandState::superseded, "a newer command came before it"});
}

void RobotLink::lost(const std::vector<std::uint32_t>& numbers) {
  counters_.frames_lost += numbers.size();
  for (const std::uint32_t number : numbers) {
    evidence_.on_lost(number);
    reports_.on_lost(number);
    digests_.on_lost(number);
    if (request_) request_->transit.on_lost(number);
  }
}

// ---- What is sent -------------------------------------------------------------------------------

std::optional<std::vector<std::uint8_t>> RobotLink::next_frame(MonotonicTime now) {
  if (phase_ == Phase::rejected) return std::nullopt;
  if (phase_ == Phase::connected && silent_too_long(now)) say_hello_from(now);
  if (phase_ == Phase::hello) return hello_frame(now);
  give_up_late_frames(now);
  open_round_if_due(now);
  // Asked even when something else is due: that it must wait is what lets the budget grow.
  if (evidence_waits()) (void)budget_.may_send(Traffic::map, now);
  if (!something_is_due(now)) return std::nullopt;
  return session_frame(now);
}

void RobotLink::give_up_late_frames(MonotonicTime now) {
  const int timeouts = flight_.timeouts();
  const auto late = flight_.on_time(now);
  budget_.on_fate(0, late.size());
  // A timeout is a lost packet among few; three in a row are silence.
  if (flight_.timeouts() > std::max(timeouts, 2)) budget_.on_silence();
  lost(late);
}

void RobotLink::say_hello_from(MonotonicTime now) {
  phase_ = Phase::hello;
  hello_due_ = now;
  hello_wait_ = kFirstHelloWait;
  unanswered_since_.reset();
}

std::optional<std::vector<std::uint8_t>> RobotLink::hello_frame(MonotonicTime now) {
  if (hello_due_ && now < *hello_due_) return std::nullopt;
  hello_due_ = now + hello_wait_;
  hello_wait_ = std::min(2 * hello_wait_, kMostHelloWait);
  FrameWriter frame({.direction = Direction::up, .session = 0, .number = ++hellos_});
  frame.add(Hello{.robot = config_.robot,
                  .site = config_.site,
                  .boot = config_.boot,
                  .cell_size_mm = static_cast<std::uint16_t>(config_.cell_size_mm),
                  .clock_ms = to_clock_ms(now)});
  budget_.sent(Traffic::control, frame.size_bytes() + overhead_bytes_, now);
  return finish(std::move(frame));
}

std::optional<std::vector<std::uint8_t>> RobotLink::session_frame(MonotonicTime now) {
  std::vector<std::uint32_t> out_of_reach;
  const std::uint32_t number = flight_.next_number(out_of_reach);
  lost(out_of_reach);
  FrameWriter frame({.direction = Direction::up, .session = session_, .number = number});
  if (ack_due_ && frame.add(received_.tell(now))) {
    ack_due_.reset();
    map_unacked_ = 0;
  }
  const bool pose_due = pose_is_due(now);
  bool urgent = reports_.fill(frame, number) > 0;
  if (request_waits() && frame.add(request_->record)) {
    request_->transit.sent(number);
    urgent = true;
  }
  const bool first_pose = pose_ && !told_;
  if (pose_) pose_->asks = asks(now);
  const bool pose = pose_due && frame.add(*pose_);
  if (pose) {
    if (pose_->asks && !unanswered_since_) unanswered_since_ = now;
    told_ = std::exchange(pose_, std::nullopt);
    told_at_ = now;
    add_spool_if_due(frame, now);
  }
  // What somebody waits for travels in short frames, and so does a session's first pose.
  const bool brief = urgent || first_pose;
  const bool digests = !brief && digests_may_go(now) && digests_.fill(frame, number) > 0;
  const bool evidence = !brief && evidence_may_go(now) && evidence_.fill(frame, number) > 0;
  if (!evidence_.round_has_news()) round_open_ = false;
  const std::size_t bytes = frame.size_bytes() + overhead_bytes_;
  const bool map = evidence || digests;
  budget_.sent(map ? Traffic::map : pose ? Traffic::pose : Traffic::control, bytes, now);
  if (urgent || map) {
    const auto load = urgent ? Flight::Load::urgent : Flight::Load::evidence;
    flight_.sent(number, load, {bytes, budget_.total()}, now);
    if (!unanswered_since_) unanswered_since_ = now;
  }
  return finish(std::move(frame));
}

/// A robot that is on its way wants to know that the server is there.
bool RobotLink::asks(MonotonicTime now) const {
  const bool on_its_way = pose_->command != 0 || pose_->speed_mm_s != 0;
  return on_its_way && (!heard_at_ || now - *heard_at_ >= kAsksAfter);
}

void RobotLink::add_spool_if_due(FrameWriter& frame, MonotonicTime now) {
  if (!spool_ || (spool_told_at_ && spool_told_ == spool_)) return;
  const bool due = !spool_told_at_ || now - *spool_told_at_ >= config_.spool_period;
  if (!due || !frame.add(*spool_)) return;
  spool_told_at_ = now;
  spool_told_ = spool_;
}

std::optional<std::vector<std::uint8_t>> RobotLink::goodbye() {
  if (!connected()) return std::nullopt;
  std::vector<std::uint32_t> out_of_reach;
  const std::uint32_t number = flight_.next_number(out_of_reach);
  lost(out_of_reach);
  FrameWriter frame({.direction = Direction::up, .session = session_, .number = number});
  frame.add(Bye{});
  return finish(std::move(frame));
}

std::vector<std::uint8_t> RobotLink::finish(FrameWriter&& frame) {
  ++counters_.frames_sent;
  counters_.bytes_sent += frame.size_bytes() + overhead_bytes_;
  return std::move(frame).finish();
}

// ---- What is due --------------------------------------------------------------------------------

bool RobotLink::silent_too_long(MonotonicTime now) const {
  return unanswered_since_ && now - *unanswered_since_ >= kSilence;
}

MonotonicTime RobotLink::pose_due(MonotonicTime now) const {
  if (!told_) return now;
  const bool news = tells_more(*told_, *pose_);
  // What became of a command is read together with where the robot is.
  if (news && reports_.has_news()) return now;
  const MonotonicTime due = told_at_ + (news ? config_.pose_period : config_.quiet_pose_period);
  return std::max(due, budget_.due(Traffic::pose, now));
}

bool RobotLink::pose_is_due(MonotonicTime now) const { return pose_ && now >= pose_due(now); }

void RobotLink::open_round_if_due(MonotonicTime now) {
  round_open_ = round_open_ && evidence_.round_has_news();
  if (round_open_ || now < round_due(now) || !evidence_.has_news()) return;
  round_open_ = true;
  evidence_.begin_round(flight_.last_number());
  round_due_ = now + config_.evidence_period;
}

/// Evidence sets out with a pose, if one is due soon: one frame for both.
MonotonicTime RobotLink::round_due(MonotonicTime now) const {
  if (!pose_ || !told_) return round_due_;
  const MonotonicTime pose = pose_due(now);
  return pose <= round_due_ + config_.evidence_period ? std::max(round_due_, pose) : round_due_;
}

bool RobotLink::evidence_waits() const {
  return round_open_ && flight_.evidence_may_go() && evidence_.round_has_news();
}

bool RobotLink::evidence_may_go(MonotonicTime now) const {
  return evidence_waits() && budget_.due(Traffic::map, now) <= now;
}

bool RobotLink::digests_wait() const { return flight_.evidence_may_go() && digests_.has_news(); }

bool RobotLink::digests_may_go(MonotonicTime now) const {
  return digests_wait() && budget_.due(Traffic::map, now) <= now;
}

RobotLink::DigestWish RobotLink::digest_wish(MonotonicTime now) const {
  if (!connected() || !digests_.idle()) return DigestWish::none;
  if (!digests_due_) return DigestWish::all;
  return now >= *digests_due_ ? DigestWish::some : DigestWish::none;
}

void RobotLink::tell_digests(std::vector<MapDigest> digests, MonotonicTime now) {
  digests_.tell(std::move(digests));
  digests_due_ = now + config_.digest_period;
}

bool RobotLink::something_is_due(MonotonicTime now) const {
  const bool ack = ack_due_ && now >= *ack_due_;
  return ack || reports_.has_news() || request_waits() || pose_is_due(now) || digests_may_go(now) ||
         evidence_may_go(now);
}

MonotonicTime RobotLink::next_due(MonotonicTime now) const {
  if (phase_ == Phase::rejected) return now + kNothingDue;
  if (phase_ == Phase::hello) return std::max(now, hello_due_.value_or(now));
  if (something_is_due(now)) return now;
  MonotonicTime due = now + kNothingDue;
  if (ack_due_) due = std::min(due, *ack_due_);
  if (pose_) due = std::min(due, pose_due(now));
  if (evidence_waits() || digests_wait()) due = std::min(due, budget_.due(Traffic::map, now));
  const bool round_ended = !round_open_ || !evidence_.round_has_news();
  if (round_ended && evidence_.has_news()) due = std::min(due, round_due(now));
  if (const auto timeout = flight_.due()) due = std::min(due, *timeout);
  if (unanswered_since_) due = std::min(due, *unanswered_since_ + kSilence);
  return std::max(now, due);
}

}  // namespace cairn::proto
