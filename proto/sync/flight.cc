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

Flight::Flight(int window_frames)
    : most_window_(window_frames), window_(std::min(kFirstWindow, window_frames)) {
  assert(window_frames >= kLeastWindow);
}

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

void Flight::sent(std::uint32_t number, bool evidence, MonotonicTime now) {
  assert(number == last_number_);
  frames_[number] = {.at = now, .evidence = evidence};
  if (evidence) ++evidence_under_way_;
}

Flight::News Flight::on_ack(const Ack& ack, MonotonicTime now) {
  News news;
  if (ack.cumulative > last_number_) return news;
  std::optional<MonotonicTime> newest_sent_at;
  for (auto frame = frames_.begin(); frame != frames_.end();) {
    const auto here = frame++;
    if (!covers(ack, here->first)) continue;
    newest_sent_at = here->second.at;
    news.acked.push_back(here->first);
    acknowledge(here);
  }
  if (newest_sent_at) {
    round_trip_.measured(std::max(now - *newest_sent_at, Duration::zero()));
    backoff_ = 0;
  }
  for (auto& [number, frame] : frames_) {
    if (frame.lost || frame.newer_acked < kPacketThreshold) continue;
    lose(frame);
    news.lost.push_back(number);
  }
  return news;
}

void Flight::acknowledge(Frames::iterator frame) {
  if (frame->second.evidence) {
    if (!frame->second.lost) --evidence_under_way_;
    window_ = std::min(window_ + 1, most_window_);
  }
  for (auto older = frames_.begin(); older != frame; ++older) ++older->second.newer_acked;
  frames_.erase(frame);
}

std::vector<std::uint32_t> Flight::on_time(MonotonicTime now) {
  std::vector<std::uint32_t> lost;
  const Duration wait = patience();
  for (auto& [number, frame] : frames_) {
    if (frame.lost || frame.at + wait > now) continue;
    lose(frame);
    lost.push_back(number);
  }
  if (!lost.empty()) {
    backoff_ = std::min(backoff_ + 1, kMostDoublings);
    window_ = std::max(window_ / 2, kLeastWindow);
  }
  return lost;
}

std::vector<std::uint32_t> Flight::lose_all() {
  std::vector<std::uint32_t> lost;
  for (auto& [number, frame] : frames_) {
    if (frame.lost) continue;
    lose(frame);
    lost.push_back(number);
  }
  backoff_ = 0;
  return lost;
}

void Flight::lose(Sent& frame) {
  frame.lost = true;
  if (frame.evidence) --evidence_under_way_;
}

void Flight::reset() {
  frames_.clear();
  last_number_ = 0;
  evidence_under_way_ = 0;
  backoff_ = 0;
}

bool Flight::evidence_may_go() const {
  if (evidence_under_way_ >= window_) return false;
  const auto oldest =
      std::ranges::find_if(frames_, [](const auto& entry) { return !entry.second.lost; });
  return oldest == frames_.end() || last_number_ - oldest->first < kEvidenceReach;
}

std::optional<MonotonicTime> Flight::due() const {
  std::optional<MonotonicTime> oldest;
  for (const auto& [number, frame] : frames_) {
    if (!frame.lost) oldest = oldest ? std::min(*oldest, frame.at) : frame.at;
  }
  if (oldest) *oldest += patience();
  return oldest;
}

Duration Flight::patience() const {
  return std::min(round_trip_.timeout() * (1 << backoff_), RoundTrip::kMaxTimeout);
}

}  // namespace cairn::proto
