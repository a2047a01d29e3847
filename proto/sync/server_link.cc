#include "proto/sync/server_link.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

namespace cairn::proto {
namespace {

bool elicits_ack(const ServerLink::Evidence& evidence, bool answer_soon) {
  return answer_soon || !evidence.heads.empty() || !evidence.blocks.empty();
}

bool same_block(const Refusal& a, const Refusal& b) {
  return a.sequence == b.sequence && a.key == b.key;
}

}  // namespace

ServerLink::ServerLink(std::uint32_t session, const Hello& hello, std::uint64_t epoch,
                       std::size_t carrier_overhead_bytes, MonotonicTime now,
                       const BudgetConfig& budget)
    : welcome_{.session = session, .boot = hello.boot, .epoch = epoch},
      robot_(hello.robot),
      overhead_bytes_(carrier_overhead_bytes),
      budget_(budget),
      heard_at_(now),
      stamp_{.clock_ms = hello.clock_ms, .at = now} {
  assert(session != 0);
}

std::optional<Duration> ServerLink::round_trip() const { return flight_.round_trip().smoothed(); }

// ---- What arrives -------------------------------------------------------------------------------

std::vector<ServerLink::Event> ServerLink::on_frame(const Frame& frame, std::size_t size_bytes,
                                                    MonotonicTime now) {
  assert(frame.header.session == session());
  const std::uint32_t number = frame.header.number;
  count(frame, size_bytes + overhead_bytes_);
  heard_at_ = now;
  if (received_.is_done(number)) {
    if (done_.is_done(number)) acknowledge_by(now + RobotLink::kAckDelay);
    return {};
  }
  received_.done(number);

  std::vector<Event> events;
  Evidence evidence{.number = number, .heads = {}, .blocks = {}, .earlier = {}};
  bool answer_soon = false;  ///< Whatever evidence there is.
  bool asked = false;        ///< Whether this end is there.
  for (const Record& record : frame.records) {
    if (const auto* ack = std::get_if<Ack>(&record)) on_ack(*ack, now);
    if (const auto* head = std::get_if<SubmapHead>(&record)) evidence.heads.push_back(*head);
    if (const auto* bye = std::get_if<Bye>(&record)) events.emplace_back(*bye);
    if (const auto* pose = std::get_if<PoseReport>(&record)) {
      asked = pose->asks;
      if (take(*pose, now)) events.emplace_back(*pose);
    }
    if (const auto* spool = std::get_if<SpoolReport>(&record)) events.emplace_back(*spool);
    if (const auto* digest = std::get_if<MapDigest>(&record)) {
      answer_soon = true;
      events.emplace_back(*digest);
    }
    if (const auto* report = std::get_if<CommandReport>(&record)) {
      answer_soon = true;
      if (take(*report, number)) events.emplace_back(*report);
    }
    if (const auto* request = std::get_if<CorridorRequest>(&record)) {
      answer_soon = true;
      events.emplace_back(*request);
    }
  }
  if (!read_patches(frame, evidence.blocks) || !name_earlier(evidence)) return events;
  const bool eager = elicits_ack(evidence, answer_soon);
  if (!evidence.heads.empty() || !evidence.blocks.empty()) {
    lone_ = !evidence_at_ || now - *evidence_at_ > kLoneAfter;
    evidence_at_ = now;
    arrived_[number] = now;
    if (arrived_.size() > kMaxUncommitted) arrived_.erase(arrived_.begin());
    events.emplace_back(std::move(evidence));
  } else {
    done_.done(number, eager ? std::optional(now) : std::nullopt);
    acknowledge_by(now + (eager || asked ? RobotLink::kAckDelay : kLazyAckDelay));
  }
  return events;
}

bool ServerLink::read_patches(const Frame& frame, std::vector<BlockUpdate>& blocks) {
  for (const Record& record : frame.records) {
    const auto* patch = std::get_if<EvidencePatch>(&record);
    if (patch == nullptr) continue;
    auto read = patches_.read(frame.header.number, *patch);
    if (read.outcome == PatchReceiver::Outcome::lost) ground_lost_ = {patch->ground.epoch};
    if (read.outcome != PatchReceiver::Outcome::read) return false;
    std::ranges::move(read.blocks, std::back_inserter(blocks));
  }
  return true;
}

bool ServerLink::name_earlier(Evidence& evidence) {
  for (const SubmapHead& head : evidence.heads) {
    if (head.earlier) borrowed_[head.sequence] = *head.earlier;
  }
  while (borrowed_.size() > kMaxBorrowed) borrowed_.erase(borrowed_.begin());
  const auto knows = [&](std::uint32_t sequence) {
    if (sequence < kFirstBorrowedSequence) return true;
    const auto found = borrowed_.find(sequence);
    if (found == borrowed_.end()) return false;
    evidence.earlier[sequence] = found->second;
    return true;
  };
  return std::ranges::all_of(evidence.heads, knows, &SubmapHead::sequence) &&
         std::ranges::all_of(evidence.blocks, knows, &BlockUpdate::sequence);
}

SubmapId ServerLink::Evidence::submap(std::uint64_t boot, std::uint32_t sequence) const {
  const auto found = earlier.find(sequence);
  return found == earlier.end() ? SubmapId{boot, sequence} : found->second;
}

void ServerLink::count(const Frame& frame, std::size_t bytes) {
  ++counters_.frames_received;
  counters_.bytes_received += bytes;
  Traffic kind = Traffic::control;
  for (const Record& record : frame.records) {
    if (std::holds_alternative<PoseReport>(record)) kind = std::max(kind, Traffic::pose);
    if (std::holds_alternative<SubmapHead>(record) ||
        std::holds_alternative<EvidencePatch>(record) ||
        std::holds_alternative<MapDigest>(record)) {
      kind = Traffic::map;
    }
  }
  counters_.received_bytes[static_cast<std::size_t>(kind)] += bytes;
  // A gap counts as missed until what is missing comes after all.
  const std::uint32_t number = frame.header.number;
  if (number > highest_number_) {
    counters_.frames_missed += number - highest_number_ - 1;
    highest_number_ = number;
  } else if (!received_.is_done(number) && counters_.frames_missed > 0) {
    --counters_.frames_missed;
  }
}

void ServerLink::on_ack(const Ack& ack, MonotonicTime now) {
  const Flight::News news = flight_.on_ack(ack, now);
  if (news.round_trip) budget_.on_round_trip(*news.round_trip, news.newest, now);
  budget_.on_fate(news.acked.size(), news.lost.size(), news.found_again);
  counters_.frames_lost -= news.found_again;
  for (const std::uint32_t number : news.acked) {
    orders_.on_acked(number);
    corridors_.on_acked(number);
    map_.on_acked(number);
  }
  lost(news.lost);
}

bool ServerLink::take(const PoseReport& pose, MonotonicTime now) {
  if (pose.clock_ms < newest_pose_ms_) return false;  // Overtaken on the way.
  newest_pose_ms_ = pose.clock_ms;
  // The first pose may have been taken a moment before the Hello was sent.
  if (pose.clock_ms >= stamp_.clock_ms) stamp_ = {.clock_ms = pose.clock_ms, .at = now};
  return true;
}

bool ServerLink::take(const CommandReport& report, std::uint32_t number) {
  orders_.on_report(report);
  const auto known = std::ranges::find_if(heard_, [&](const Heard& heard) {
    return heard.report.command == report.command && heard.report.revision == report.revision;
  });
  if (known == heard_.end()) {
    if (heard_.size() == ReportBoard::kMaxReports) heard_.pop_front();
    heard_.push_back({report, number});
    return true;
  }
  // Frames with higher numbers were made later: what they say is newer.
  if (number < known->number || known->report == report) return false;
  *known = {report, number};
  return true;
}

void ServerLink::durable(std::uint32_t number) {
  const auto arrived = arrived_.extract(number);
  done_.done(number, arrived ? std::optional(arrived.mapped()) : std::nullopt);
  const bool many = ++durable_unacked_ >= RobotLink::kMostMapUnacked;
  const Duration wait = lone_ ? RobotLink::kAckDelay : RobotLink::kMapAckDelay;
  acknowledge_by(many ? heard_at_ : heard_at_ + wait);
}

void ServerLink::refuse(const Refusal& refusal) {
  const auto known = std::ranges::find_if(
      refusals_, [&](const Refusal& waiting) { return same_block(waiting, refusal); });
  if (known != refusals_.end()) {
    *known = refusal;
  } else if (refusals_.size() < kMaxRefusals) {
    refusals_.push_back(refusal);
  }
}

void ServerLink::welcome_again() { welcome_due_ = true; }

void ServerLink::command(Command command, const std::vector<std::uint8_t>& path,
                         Duration expires_in, MonotonicTime now) {
  corridors_.clear();
  orders_.set(std::move(command), path, now + expires_in);
}

void ServerLink::corridor(CorridorPart part) { corridors_.add(std::move(part)); }

void ServerLink::lost(const std::vector<std::uint32_t>& numbers) {
  counters_.frames_lost += numbers.size();
  for (const std::uint32_t number : numbers) {
    orders_.on_lost(number);
    corridors_.on_lost(number);
    map_.on_lost(number);
  }
}

void ServerLink::acknowledge_by(MonotonicTime due) {
  ack_due_ = ack_due_ ? std::min(*ack_due_, due) : due;
}

// ---- What is sent -------------------------------------------------------------------------------

std::optional<std::vector<std::uint8_t>> ServerLink::next_frame(MonotonicTime now) {
  give_up_late_frames(now);
  orders_.ask_again_if_due(now);
  if (map_waits()) (void)budget_.may_send(Traffic::map, now);
  if (!something_is_due(now)) return std::nullopt;
  return session_frame(now);
}

void ServerLink::give_up_late_frames(MonotonicTime now) {
  const int timeouts = flight_.timeouts();
  const auto late = flight_.on_time(now);
  budget_.on_fate(0, late.size());
  // A timeout is a lost packet among few; three in a row are silence.
  if (flight_.timeouts() > std::max(timeouts, 2)) budget_.on_silence();
  lost(late);
}

std::vector<std::uint8_t> ServerLink::session_frame(MonotonicTime now) {
  std::vector<std::uint32_t> out_of_reach;
  const std::uint32_t number = flight_.next_number(out_of_reach);
  lost(out_of_reach);
  FrameWriter frame({.direction = Direction::down, .session = session(), .number = number});
  if (welcome_due_) {
    // Alone, so that it is short enough to ride on a carrier's own answer to the robot.
    welcome_due_ = !frame.add(welcome_);
    return finish(std::move(frame), Traffic::control, std::nullopt, now);
  }
  const bool command =
      orders_.fill_command(frame, number, in_robot_clock(orders_.expires_at()), now);
  if (ack_due_ && frame.add(done_.tell(now))) {
    ack_due_.reset();
    durable_unacked_ = 0;
  }
  // Short, and somebody waits for it.
  if (command) return finish(std::move(frame), Traffic::control, Flight::Load::urgent, now);
  const bool details = detail_may_go(now);
  const bool parts = details && orders_.fill_parts(frame, number);
  if (details) add_refusals(frame);
  if (details && ground_lost_ && frame.add(*ground_lost_)) ground_lost_.reset();
  bool map = false;
  if (map_may_go(now)) {
    map = corridors_.fill(frame, number) > 0;
    map = map_.fill(frame, number) > 0 || map;
  }
  if (map) return finish(std::move(frame), Traffic::map, Flight::Load::evidence, now);
  if (parts) return finish(std::move(frame), Traffic::pose, Flight::Load::other, now);
  return finish(std::move(frame), details ? Traffic::pose : Traffic::control, std::nullopt, now);
}

std::vector<std::uint8_t> ServerLink::finish(FrameWriter&& frame, Traffic kind,
                                             std::optional<Flight::Load> eliciting,
                                             MonotonicTime now) {
  const std::size_t bytes = frame.size_bytes() + overhead_bytes_;
  ++counters_.frames_sent;
  counters_.bytes_sent += bytes;
  budget_.sent(kind, bytes, now);
  if (eliciting) flight_.sent(flight_.last_number(), *eliciting, {bytes, budget_.total()}, now);
  return std::move(frame).finish();
}

void ServerLink::add_refusals(FrameWriter& frame) {
  const auto first_left =
      std::ranges::find_if(refusals_, [&](const Refusal& refusal) { return !frame.add(refusal); });
  refusals_.erase(refusals_.begin(), first_left);
}

std::uint64_t ServerLink::in_robot_clock(MonotonicTime time) const {
  // The stamp was older than `at` by the unknown delay of its frame: that time is lost to the
  // command, never added.
  const auto after_stamp_ms =
      std::chrono::floor<std::chrono::milliseconds>(time - stamp_.at).count();
  if (after_stamp_ms >= 0) return stamp_.clock_ms + static_cast<std::uint64_t>(after_stamp_ms);
  const auto before = static_cast<std::uint64_t>(-after_stamp_ms);
  return before > stamp_.clock_ms ? 0 : stamp_.clock_ms - before;
}

bool ServerLink::map_may_go(MonotonicTime now) const {
  return map_waits() && budget_.due(Traffic::map, now) <= now;
}

bool ServerLink::detail_may_go(MonotonicTime now) const {
  return detail_waits() && budget_.due(Traffic::pose, now) <= now;
}

bool ServerLink::something_is_due(MonotonicTime now) const {
  const bool ack = ack_due_ && now >= *ack_due_;
  return welcome_due_ || ack || orders_.record_waits() || detail_may_go(now) || map_may_go(now);
}

MonotonicTime ServerLink::next_due(MonotonicTime now) const {
  if (something_is_due(now)) return now;
  MonotonicTime due = now + RobotLink::kNothingDue;
  if (ack_due_) due = std::min(due, *ack_due_);
  if (detail_waits()) due = std::min(due, budget_.due(Traffic::pose, now));
  if (map_waits()) due = std::min(due, budget_.due(Traffic::map, now));
  if (const auto timeout = flight_.due()) due = std::min(due, *timeout);
  if (const auto ask = orders_.ask_due()) due = std::min(due, *ask);
  return std::max(now, due);
}

Verdict judge(std::uint32_t held, std::uint32_t base, std::uint32_t version) {
  if (held >= version) return Verdict::stale;
  return held < base ? Verdict::refuse : Verdict::apply;
}

}  // namespace cairn::proto
