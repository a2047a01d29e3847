#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/delta/logistic.h"

namespace cairn::proto {

/// What was seen under one context: how likely a set bit is, and on how many bits that rests.
struct BitStatistics {
  std::uint16_t one = 32768;  ///< [1/65536]
  std::uint16_t seen = 0;
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
  int most_seen = 255;   ///< Statistics never rest on more bits: they follow what changes.
  int weight_rate = 10;  ///< [1/2^18] Step of a weight.
};

/// Predicts a bit from several contexts at once: their log odds are weighted, and the weights learn
/// from each bit which contexts to trust (logistic mixing, Mahoney 2005). Two sets of weights, each
/// chosen by a context of its own, are asked and their answers averaged. Whole numbers only.
class BitMixer {
 public:
  static constexpr std::size_t kMaxInputs = 12;  ///< Of which the last is constant.

  /// Requires: statistics and weights as large as the contexts and sets used.
  BitMixer(MixerState& state, const Learning& learning) : state_(state), learning_(learning) {}

  /// Begins the next bit.
  void begin() { inputs_ = 0; }
  /// One more context. Requires: fewer than kMaxInputs - 1 so far.
  void add(std::size_t context);
  /// Codes the bit as the coder does (a decoder returns what it read) and learns from it.
  template <class Coder>
  bool code(Coder& coder, bool bit, std::size_t first_set, std::size_t second_set) {
    const bool coded = coder.code(bit, predict(first_set, second_set));
    learn(coded);
    return coded;
  }

 private:
  struct Ask {
    std::int32_t* weights = nullptr;
    int logit = 0;
  };

  std::uint32_t predict(std::size_t first_set, std::size_t second_set);
  [[nodiscard]] Ask ask(std::size_t set);
  void learn(bool bit);
  void learn(const Ask& ask, bool bit);

  MixerState& state_;
  Learning learning_;
  std::size_t inputs_ = 0;
  std::array<BitStatistics*, kMaxInputs> asked_{};
  std::array<int, kMaxInputs> logits_{};
  Ask first_;
  Ask second_;
};

}  // namespace cairn::proto
