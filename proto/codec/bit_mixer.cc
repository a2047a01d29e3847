#include "proto/codec/bit_mixer.h"

#include <algorithm>
#include <cassert>

namespace cairn::proto {
namespace {

constexpr int kConstantInput = 256;  // One nat.
constexpr int kLeastOne = 24;        // No bit is ever held for impossible.
constexpr std::int32_t kMaxWeight = 1 << 19;
constexpr std::size_t kRates = 1024;

/// [1/65536] How much a statistic on `seen` bits follows the next: 1 / (seen + 1.6).
constexpr auto make_rates() {
  std::array<std::int32_t, kRates> rates{};
  for (std::size_t seen = 0; seen < kRates; ++seen) {
    rates[seen] = static_cast<std::int32_t>(65536 * 10 / (10 * seen + 16));
  }
  return rates;
}
constexpr std::array<std::int32_t, kRates> kRate = make_rates();

/// [1/256] How far a statistic on so few bits is trusted: seen / (seen + 0.6).
constexpr auto make_trust() {
  std::array<std::int32_t, kRates> trust{};
  for (std::size_t seen = 0; seen < kRates; ++seen) {
    trust[seen] = static_cast<std::int32_t>(256 * 10 * seen / (10 * seen + 6));
  }
  return trust;
}
constexpr std::array<std::int32_t, kRates> kTrust = make_trust();

}  // namespace

void BitMixer::add(std::size_t context) {
  assert(inputs_ + 1 < kMaxInputs && context < state_.statistics.size());
  BitStatistics& statistics = state_.statistics[context];
  asked_[inputs_] = &statistics;
  logits_[inputs_] = (stretch(statistics.one) * kTrust[statistics.seen]) / 256;
  ++inputs_;
}

BitMixer::Ask BitMixer::ask(std::size_t set) {
  Ask ask{&state_.weights[set * kMaxInputs]};
  std::int64_t sum = std::int64_t{ask.weights[kMaxInputs - 1]} * kConstantInput;
  for (std::size_t i = 0; i < inputs_; ++i) sum += std::int64_t{ask.weights[i]} * logits_[i];
  ask.logit = static_cast<int>(std::clamp<std::int64_t>(sum / 65536, -kLogitLimit, kLogitLimit));
  return ask;
}

std::uint32_t BitMixer::predict(std::size_t first_set, std::size_t second_set) {
  first_ = ask(first_set);
  second_ = ask(second_set);
  const int one = squash((first_.logit + second_.logit) / 2);
  return static_cast<std::uint32_t>(std::clamp(one, kLeastOne, 65536 - kLeastOne));
}

void BitMixer::learn(bool bit) {
  learn(first_, bit);
  learn(second_, bit);
  const std::int32_t target = bit ? 65535 : 0;
  for (std::size_t i = 0; i < inputs_; ++i) {
    BitStatistics& s = *asked_[i];
    const std::int32_t step =
        static_cast<std::int32_t>((std::int64_t{target - s.one} * kRate[s.seen]) / 65536);
    s.one = static_cast<std::uint16_t>(std::clamp(s.one + step, 16, 65519));
    if (s.seen < learning_.most_seen) ++s.seen;
  }
}

void BitMixer::learn(const Ask& ask, bool bit) {
  const std::int64_t error = std::int64_t{bit ? 65536 : 0} - squash(ask.logit);
  const auto moved = [&](std::int32_t weight, int input) {
    const std::int64_t step = (error * input * learning_.weight_rate) / (1 << 18);
    return static_cast<std::int32_t>(
        std::clamp<std::int64_t>(weight + step, -kMaxWeight, kMaxWeight));
  };
  for (std::size_t i = 0; i < inputs_; ++i) ask.weights[i] = moved(ask.weights[i], logits_[i]);
  std::int32_t& constant = ask.weights[kMaxInputs - 1];
  constant = moved(constant, kConstantInput);
}

}  // namespace cairn::proto
