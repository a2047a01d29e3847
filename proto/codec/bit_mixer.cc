#include "proto/codec/bit_mixer.h"

namespace cairn::proto {
namespace {

template <std::size_t N>
constexpr auto make_rates() {
  std::array<std::int32_t, N> rates{};
  for (std::size_t seen = 0; seen < N; ++seen) {
    rates[seen] = static_cast<std::int32_t>(32768 * 10 / (10 * seen + 16));
  }
  return rates;
}

template <std::size_t N>
constexpr auto make_trust() {
  std::array<std::int32_t, N> trust{};
  for (std::size_t seen = 0; seen < N; ++seen) {
    trust[seen] = static_cast<std::int32_t>(256 * 10 * seen / (10 * seen + 6));
  }
  return trust;
}

}  // namespace

constexpr std::array<std::int32_t, BitMixer::kSeenLimit> BitMixer::kRate = make_rates<kSeenLimit>();
constexpr std::array<std::int32_t, BitMixer::kSeenLimit> BitMixer::kTrust =
    make_trust<kSeenLimit>();

}  // namespace cairn::proto
