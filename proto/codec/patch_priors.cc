#include "proto/codec/patch_priors.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "proto/codec/patch.h"
#include "proto/codec/patch_contexts.h"

namespace cairn::proto {
namespace patch {
namespace {

constexpr std::string_view kLetters =
    "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz+-";
constexpr std::int32_t kFirstWeight = 65536 * 3 / 10;
constexpr int kLogitStep = kLogitUnit / 16;
constexpr std::int32_t kWeightStep = 256;
/// On how many bits a prior rests, by class.
constexpr std::array<std::uint16_t, 16> kSeen = {0,  1,  2,  3,  4,  6,  8,   12,
                                                 16, 24, 32, 48, 64, 96, 128, 255};

constexpr char kTable[] =
#include "proto/codec/patch_priors_table.inc"
    ;
constexpr char kExactTable[] =
#include "proto/codec/patch_exact_priors_table.inc"
    ;

MixerState priors_of(std::string_view table) {
  auto state = priors_from_text(table);
  assert(state && "the table was not trained for these contexts: see train_codec");
  return *std::move(state);
}

void put(std::string& text, unsigned value) {
  text += kLetters[value / 64];
  text += kLetters[value % 64];
}

unsigned get(std::string_view text, std::size_t at) {
  const auto digit = [](char letter) { return static_cast<unsigned>(kLetters.find(letter)); };
  return (digit(text[2 * at]) * 64 + digit(text[2 * at + 1])) % 4096;
}

unsigned seen_class(std::uint16_t seen) {
  const auto above = std::ranges::upper_bound(kSeen, seen);
  return static_cast<unsigned>(above - kSeen.begin() - 1);
}

}  // namespace

MixerState blank_priors() {
  return {std::vector<BitStatistics>(kContexts), std::vector<std::int32_t>(kWeights, kFirstWeight)};
}

std::string priors_to_text(const MixerState& state) {
  std::string text;
  for (const BitStatistics& s : state.statistics) {
    const int logit = std::clamp((stretch(s.one) + 2048 + kLogitStep / 2) / kLogitStep, 0, 255);
    put(text, static_cast<unsigned>(logit) * 16 + seen_class(s.seen));
  }
  for (const std::int32_t weight : state.weights) {
    put(text, static_cast<unsigned>(std::clamp(weight / kWeightStep, -2048, 2047) + 2048));
  }
  return text;
}

std::optional<MixerState> priors_from_text(std::string_view text) {
  if (text.size() != 2 * (kContexts + kWeights)) return std::nullopt;
  MixerState state = blank_priors();
  for (std::size_t i = 0; i < kContexts; ++i) {
    const unsigned value = get(text, i);
    const int logit = static_cast<int>(value / 16) * kLogitStep - 2048;
    state.statistics[i] = {static_cast<std::uint16_t>(squash(logit)), kSeen.at(value % 16)};
  }
  for (std::size_t i = 0; i < kWeights; ++i) {
    state.weights[i] = (static_cast<int>(get(text, kContexts + i)) - 2048) * kWeightStep;
  }
  return state;
}

}  // namespace patch

const MixerState& trained_priors(const Coarseness& coarseness) {
  static const MixerState coarse = patch::priors_of({patch::kTable, sizeof patch::kTable - 1});
  static const MixerState exact =
      patch::priors_of({patch::kExactTable, sizeof patch::kExactTable - 1});
  return coarseness == kExact ? exact : coarse;
}

}  // namespace cairn::proto
