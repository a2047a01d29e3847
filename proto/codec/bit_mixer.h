#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/delta/logistic.h"

namespace cairn::proto {

/// What was seen under one context: how likely a set bit is, and on how many bits that rests.
struct BitStatistics {
  std::uint16_t one = 32768;  ///< [1/65536]
  std::uint16_t seen = 0;     ///< [Limit: < 1024]
};

/// The statistics of all contexts and the weights with which they are mixed. A packet begins with
/// trained ones and learns on from there.
struct MixerState {
  std::vector<BitStatistics> statistics;
  /// By set, then input. [1/65536]
  std::vector<std::int32_t> weights;
};

/// How fast the mixer learns.
struct Learning {
  int most_seen = 255;  ///< Statistics never rest on more bits: they follow what changes.
  /// [1/2^18] Step of a weight. [Limit: ≤ 1024]
  int weight_rate = 6;
};

/// Predicts a bit from several contexts at once: their log odds are weighted, and the weights learn
/// from each bit which contexts to trust (logistic mixing, Mahoney 2005). Two sets of weights, each
/// chosen by a context of its own, are asked and their answers averaged. Whole numbers only; all of
/// 32 bits, and every shift of a negative one rounds down.
class BitMixer {
 public:
  static constexpr std::size_t kMaxInputs = 16;  ///< Of which the last is constant.

  /// Requires: statistics and weights as large as the contexts and sets used.
  BitMixer(MixerState& state, const Learning& learning) : state_(state), learning_(learning) {}

  /// Begins the next bit.
  void begin() {
    inputs_ = 0;
    logits_.fill(0);
    logits_[kMaxInputs - 1] = kConstantInput;
  }
  /// One more context. Requires: fewer than kMaxInputs - 1 so far.
  void add(std::size_t context) {
    assert(inputs_ + 1 < kMaxInputs && context < state_.statistics.size());
    BitStatistics& statistics = state_.statistics[context];
    asked_[inputs_] = &statistics;
    logits_[inputs_] = (stretch(statistics.one) * kTrust[statistics.seen]) >> 8;
    ++inputs_;
  }
  /// Codes the bit as the coder does (a decoder returns what it read) and learns from it.
  template <class Coder>
  bool code(Coder& coder, bool bit, std::size_t first_set, std::size_t second_set) {
    std::int32_t* const first = &state_.weights[first_set * kMaxInputs];
    std::int32_t* const second = &state_.weights[second_set * kMaxInputs];
    const int first_logit = mixed(first);
    const int second_logit = mixed(second);
    const int one = squash((first_logit + second_logit) >> 1);
    const bool coded =
        coder.code(bit, static_cast<std::uint32_t>(std::clamp(one, kLeastOne, 65536 - kLeastOne)));
    learn(first, first_logit, coded);
    learn(second, second_logit, coded);
    learn(coded);
    return coded;
  }

 private:
  static constexpr std::size_t kSeenLimit = 1024;
  static constexpr int kConstantInput = kLogitUnit;  // One nat.
  static constexpr int kLeastOne = 24;               // No bit is ever held for impossible.
  static constexpr std::int32_t kMaxWeight = 1 << 19;
  /// [1/32768] How much a statistic on so many bits follows the next: 1 / (seen + 1.6).
  static const std::array<std::int32_t, kSeenLimit> kRate;
  /// [1/256] How far it is trusted: seen / (seen + 0.6).
  static const std::array<std::int32_t, kSeenLimit> kTrust;

  /// Weighted log odds. Each product is below 2^30, so that the sum of their sixteenths fits.
  [[nodiscard]] int mixed(const std::int32_t* weights) const {
    std::int32_t sum = 0;
    for (std::size_t i = 0; i < kMaxInputs; ++i) sum += (weights[i] * logits_[i]) >> 4;
    return std::clamp(sum >> 12, -kLogitLimit, kLogitLimit);
  }
  /// Error · input is below 2^28.
  void learn(std::int32_t* weights, int logit, bool bit) const {
    const std::int32_t error = (bit ? 65536 : 0) - squash(logit);
    for (std::size_t i = 0; i < kMaxInputs; ++i) {
      const std::int32_t pull = ((error * logits_[i]) >> 8) * learning_.weight_rate;
      const std::int32_t step = (pull + 512) >> 10;
      weights[i] = std::clamp(weights[i] + step, -kMaxWeight, kMaxWeight);
    }
  }
  void learn(bool bit) {
    const std::int32_t target = bit ? 65535 : 0;
    for (std::size_t i = 0; i < inputs_; ++i) {
      BitStatistics& s = *asked_[i];
      const std::int32_t step = ((target - s.one) * kRate[s.seen] + (1 << 14)) >> 15;
      s.one = static_cast<std::uint16_t>(std::clamp(s.one + step, 16, 65519));
      if (s.seen < learning_.most_seen) ++s.seen;
    }
  }

  MixerState& state_;
  Learning learning_;
  std::size_t inputs_ = 0;
  std::array<BitStatistics*, kMaxInputs> asked_{};
  std::array<std::int32_t, kMaxInputs> logits_{};
};

}  // namespace cairn::proto
