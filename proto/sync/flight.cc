#include "proto/sync/flight.h"

#include <algorithm>
#include <cassert>

namespace cairn::proto {
namespace {

constexpr int kMostDoublings = 10;

bool covers(const Ack& ack, std::uint32_t number) {
  if (number <= ack.cumulative) return true;
  const std::uint64_t bit = std::uint64_t{number} - ack.cumulative;
  return bit >= 2 && bit < 66 && ((ack.bitmap >> (bit - 2)) & 1U) != 0;
}

}  // namespace

std::uint32_t Flight::next_number(std::vector<std::uint32_t>& lost) {
  ++last_number_;
  while (!frames_.empty() && frames_.begin()->first + kReach <= last_number_) {
    auto& [number, frame] = *frames_.begin();
    if (!frame.lost) {
      lose(frame);
      lost.push_back(number);
    }
    frames_.erase(frames_.begin());
  }
  return last_number_;
}

void Flight::sent(std::uint32_t number, Load load, const Budget::Mark& mark, MonotonicTime now) {
  assert(number == last_number_);
  frames_[number] = {.at = now, .load = load, .mark = mark};
  if (load == Load::evidence) ++evidence_under_way_;
}

Flight::News Flight::on_ack(const Ack& ack, MonotonicTime now) {
  News news;
  if (ack.cumulative > last_number_) return news;
  std::optional<Frames::value_type> newest;
  for (auto frame = frames_.begin(); frame != frames_.end();) {
    const auto here = frame++;
    if (!covers(ack, here->first)) continue;
    newest.emplace(*here);
    news.acked.push_back(here->first);
    if (here->second.lost) ++news.found_again;
    acknowledge(here);
  }
  if (newest) measure(*newest, ack, now, news);
  if (!news.acked.empty()) {
    backoff_ = 0;
    urgent_tries_ = 0;
  }
  for (auto& [number, frame] : frames_) {
    if (frame.lost || frame.newer_acked < kPacketThreshold) continue;
    lose(frame);
    news.lost.push_back(number);
  }
  return news;
}

/// An acknowledgement that was overtaken, or repeats a lost one, says nothing about the link.
void Flight::measure(const Frames::value_type& newest, const Ack& ack, MonotonicTime now,
                     News& news) {
  const auto& [number, sent] = newest;
  if (number < newest_acked_ || ack.delay_ms == Ack::kDelayUnknown) return;
  newest_acked_ = number;
  const Duration answered = std::max(now - sent.at, Duration::zero());
  round_trip_.measured(answered);
  const Duration waited = std::chrono::milliseconds(ack.delay_ms);
  news.round_trip = std::max(answered - waited, Duration::zero());
  news.newest = sent.mark;
}

void Flight::acknowledge(Frames::iterator frame) {
  if (frame->second.load == Load::evidence && !frame->second.lost) --evidence_under_way_;
  for (auto older = frames_.begin(); older != frame; ++older) ++older->second.newer_acked;
  frames_.erase(frame);
}

std::vector<std::uint32_t> Flight::on_time(MonotonicTime now) {
  std::vector<std::uint32_t> late;
  for (const auto& [number, frame] : frames_) {
    if (!frame.lost && due(frame) <= now) late.push_back(number);
  }
  bool silent = false;
  for (const std::uint32_t number : late) {
    Sent& frame = frames_.at(number);
    lose(frame);
    const bool patient = frame.at + patience() <= now;
    silent = silent || patient;
    if (!patient) ++urgent_tries_;
  }
  if (silent) backoff_ = std::min(backoff_ + 1, kMostDoublings);
  return late;
}

std::vector<std::uint32_t> Flight::lose_all() {
  std::vector<std::uint32_t> lost;
  for (auto& [number, frame] : frames_) {
    if (frame.lost) continue;
    lose(frame);
    lost.push_back(number);
  }
  backoff_ = 0;
  urgent_tries_ = 0;
  return lost;
}

void Flight::lose(Sent& frame) {
  frame.lost = true;
  if (frame.load == Load::evidence) --evidence_under_way_;
}

void Flight::reset() {
  frames_.clear();
  last_number_ = 0;
  newest_acked_ = 0;
  evidence_under_way_ = 0;
  backoff_ = 0;
  urgent_tries_ = 0;
}

bool Flight::evidence_may_go() const {
  if (backoff_ > 0 && evidence_under_way_ >= std::max(1, kSilentWindow >> (backoff_ - 1))) {
    return false;
  }
  const auto oldest =
      std::ranges::find_if(frames_, [](const auto& entry) { return !entry.second.lost; });
  return oldest == frames_.end() || last_number_ - oldest->first < kEvidenceReach;
}

std::size_t Flight::bytes_under_way() const {
  std::size_t bytes = 0;
  for (const auto& [number, frame] : frames_) bytes += frame.lost ? 0 : frame.mark.bytes;
  return bytes;
}

MonotonicTime Flight::due(const Sent& frame) const {
  const bool urgent = frame.load == Load::urgent && urgent_tries_ < kUrgentTries;
  return frame.at + (urgent ? std::min(urgent_patience(), patience()) : patience());
}

std::optional<MonotonicTime> Flight::due() const {
  std::optional<MonotonicTime> first;
  for (const auto& [number, frame] : frames_) {
    if (frame.lost) continue;
    first = first ? std::min(*first, due(frame)) : due(frame);
  }
  return first;
}

Duration Flight::patience() const {
  // On a link that answered before one frame lost, or its acknowledgement, is no silence yet.
  const int doublings = round_trip_.smoothed() ? std::max(0, backoff_ - 1) : backoff_;
  return std::min(round_trip_.timeout() * (1 << doublings), RoundTrip::kMaxTimeout);
}

Duration Flight::urgent_patience() const {
  if (!round_trip_.smoothed()) return kMostUrgentWait;
  return std::clamp(from_seconds(kUrgentShare * to_seconds(*round_trip_.smoothed())),
                    kLeastUrgentWait, kMostUrgentWait);
}

}  // namespace cairn::proto
