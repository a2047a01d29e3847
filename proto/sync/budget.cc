#include "proto/sync/budget.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace cairn::proto {
namespace {

constexpr double kStartGrowth = 1.5;
/// Steps after a queue was seen: slow at first, where the link's rate must be near, then bolder.
constexpr std::array<double, 6> kGrowth{1.04, 1.04, 1.04, 1.08, 1.15, 1.25};
constexpr double kShrink = 0.9;  ///< Of what the link carries.
constexpr double kBlindShrink = 0.5;
constexpr double kSilenceShrink = 0.5;
constexpr double kLossMemory = 1.0 / 32.0;
/// An excess below it is no queue.
constexpr Duration kNoQueue = std::chrono::milliseconds(30);
/// Arrivals closer together say little about a pace.
constexpr Duration kShortestPace = std::chrono::milliseconds(100);

double seconds_of(Duration d) { return to_seconds(d); }

}  // namespace

Status validate(const BudgetConfig& config) {
  if (config.floor_bit_s > 0.0 && config.floor_bit_s <= config.ceiling_bit_s) return {};
  return Error{ErrorCode::invalid_argument,
               "a link's least rate must be above 0 and not above its highest"};
}

Budget::Budget(const BudgetConfig& config) : config_(config), rate_(config.first_bit_s / 8.0) {
  set_rate(rate_);
}

void Budget::set_rate(double bytes_s) {
  rate_ = std::clamp(bytes_s, config_.floor_bit_s / 8.0, config_.ceiling_bit_s / 8.0);
}

// ---- Spending -----------------------------------------------------------------------------------

double Budget::balance_at(MonotonicTime now) const {
  const double earned = rate_ * seconds_of(std::max(now - balance_at_, Duration{}));
  return std::min(balance_ + earned, depth());
}

double Budget::depth() const { return std::max(kLongestPacket, rate_ * seconds_of(kBurst)); }

double Budget::least_balance(Traffic kind) const {
  if (kind == Traffic::control) return -std::numeric_limits<double>::infinity();
  return kind == Traffic::pose ? -rate_ * seconds_of(kPoseOverdraft) : 0.0;
}

bool Budget::may_send(Traffic kind, MonotonicTime now) {
  const bool may = due(kind, now) <= now;
  if (!may) used_up_ = true;
  return may;
}

MonotonicTime Budget::due(Traffic kind, MonotonicTime now) const {
  const double lacks = least_balance(kind) - balance_at(now);
  if (lacks <= 0.0) return now;
  // A microsecond more than needed, so that at that time rounding does not say "not yet".
  const MonotonicTime paid = now + from_seconds(lacks / rate_) + Duration(1);
  const Duration patience = kind == Traffic::map ? kMapPatience : kPosePatience;
  return std::max(now, std::min(paid, sent_at_[static_cast<std::size_t>(kind)] + patience));
}

void Budget::sent(Traffic kind, std::size_t bytes, MonotonicTime now) {
  if (total() == 0) changed_at_ = now;
  sent_bytes_[static_cast<std::size_t>(kind)] += bytes;
  const double most_debt = rate_ * seconds_of(kMostOverdraft) + kLongestPacket;
  balance_ = std::max(balance_at(now) - static_cast<double>(bytes), -most_debt);
  balance_at_ = now;
  sent_at_[static_cast<std::size_t>(kind)] = now;
}

std::uint64_t Budget::total() const {
  std::uint64_t total = 0;
  for (const std::uint64_t bytes : sent_bytes_) total += bytes;
  return total;
}

// ---- Learning -----------------------------------------------------------------------------------

Duration Budget::packet_time() const { return from_seconds(kLongestPacket / rate_); }

Duration Budget::target() const { return kQueueTarget + packet_time(); }

void Budget::note_idle(const Idle& seen, MonotonicTime now) {
  if (now - idle_turn_ >= kMemory / 2) {
    idle_[1] = std::exchange(idle_[0], std::nullopt);
    idle_turn_ = now;
    // A queue too short to shrink for must not pass for the idle link once that is forgotten.
    if (queue_ > kNoQueue) pause(queue_, now);
  }
  if (!idle_[0] || seen.round_trip < idle_[0]->round_trip) idle_[0] = seen;
}

Budget::Idle Budget::idle() const {
  const Idle none{};
  if (!idle_[0]) return idle_[1].value_or(none);
  if (!idle_[1]) return *idle_[0];
  return idle_[1]->round_trip < idle_[0]->round_trip ? *idle_[1] : *idle_[0];
}

/// What arrives one behind the other out of a queue tells what the link carries; lost packets
/// between two that arrived took their time on it as well.
std::optional<double> Budget::capacity() const {
  if (busy_.size() < 2) return std::nullopt;
  const Duration span = busy_.back().at - busy_.front().at;
  if (span < kShortestPace) return std::nullopt;
  return static_cast<double>(busy_.back().total - busy_.front().total) / seconds_of(span);
}

void Budget::note_excess(Duration excess, const Mark& frame, MonotonicTime now) {
  recent_[samples_++ % recent_.size()] = excess;
  const auto known = static_cast<std::ptrdiff_t>(std::min(samples_, recent_.size()));
  queue_ = *std::min_element(recent_.begin(), recent_.begin() + known);
  if (excess < kNoQueue) busy_.clear();
  const bool soon = !busy_.empty() && now - busy_.back().at < kShortestPace / 8;
  if (soon || (!busy_.empty() && frame.total <= busy_.back().total)) return;
  if (busy_.size() == kMaxArrivals) busy_.pop_front();
  busy_.push_back({now, frame.total});
}

void Budget::on_round_trip(Duration round_trip, const Mark& frame, MonotonicTime now) {
  note_idle({round_trip, frame.bytes}, now);
  const Idle quick = idle();
  const std::size_t longer = frame.bytes - std::min(frame.bytes, quick.bytes);
  const Duration own_time = from_seconds(static_cast<double>(longer) / std::max(rate_, carried_));
  const Duration excess = std::max(round_trip - quick.round_trip - own_time, Duration{});
  if (excess < kNoQueue) on_return();
  note_excess(excess, frame, now);
  const MonotonicTime sent_at = now - round_trip;
  if (sent_at < changed_at_) return;  // It tells of another rate.
  const bool sure = samples_ >= recent_.size();
  if ((sure && queue_ > target()) || excess > 2 * target() || loss_ > kMostLoss) {
    return shrink(frame, now);
  }
  // Only what was sent a while after the change has met the queue that it made.
  const Duration settling = std::max(quick.round_trip / 2, 2 * packet_time());
  if (used_up_ && queue_ < target() / 3 && sent_at >= changed_at_ + settling) grow(now);
}

void Budget::grow(MonotonicTime now) {
  set_rate(rate_ * (starting_ ? kStartGrowth : kGrowth[std::min(steps_, kGrowth.size() - 1)]));
  ++steps_;
  used_up_ = false;
  changed_at_ = now;
}

void Budget::pause(Duration length, MonotonicTime now) {
  balance_ = std::min(balance_at(now), 0.0) - rate_ * seconds_of(length);
  balance_at_ = now;
}

void Budget::shrink(const Mark& newest, MonotonicTime now) {
  const double carried = std::min(capacity().value_or(kBlindShrink * rate_), rate_);
  carried_ = carried;
  before_silence_ = 0.0;
  set_rate(kShrink * carried);
  // What was sent since the newest frame that arrived is on the way or in the queue.
  const auto outstanding = static_cast<double>(total() - newest.total);
  pause(std::max(queue_, from_seconds(outstanding / carried) - idle().round_trip), now);
  starting_ = false;
  steps_ = 0;
  loss_ = std::min(loss_, kMostLoss);
  changed_at_ = now;
  samples_ = 0;
  busy_.clear();
}

void Budget::on_fate(std::size_t acknowledged, std::size_t lost, std::size_t found_again) {
  for (std::size_t i = 0; i < found_again; ++i) {
    loss_ = std::max(0.0, (loss_ - kLossMemory) / (1.0 - kLossMemory));
  }
  for (std::size_t i = 0; i < acknowledged; ++i) loss_ -= loss_ * kLossMemory;
  for (std::size_t i = 0; i < lost; ++i) loss_ += (1.0 - loss_) * kLossMemory;
}

void Budget::on_return() {
  if (before_silence_ > rate_) set_rate(before_silence_);
  before_silence_ = 0.0;
}

void Budget::on_silence() {
  before_silence_ = std::max(before_silence_, rate_);
  set_rate(std::max(rate_ * kSilenceShrink, std::min(rate_, config_.first_bit_s / 8.0)));
  starting_ = true;  // Whatever comes back may be another link.
}

}  // namespace cairn::proto
