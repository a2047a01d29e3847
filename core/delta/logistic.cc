#include "core/delta/logistic.h"

namespace cairn::logistic {
namespace {

constexpr std::uint64_t kOne = std::uint64_t{1} << 32U;
/// exp(-1/256) · 2^32, to nearest.
constexpr std::uint64_t kStepDown = 4'278'222'805;

/// 65536 / (1 + exp(-x)) for x = -2047/256 … 2047/256, to nearest.
constexpr auto make_squash() {
  std::array<std::uint16_t, 2 * kLogitLimit + 1> table{};
  std::uint64_t decay = kOne;  // exp(-x) · 2^32
  for (std::size_t x = 0; x <= kLogitLimit; ++x) {
    const std::uint64_t above = ((kOne << 16U) + (kOne + decay) / 2) / (kOne + decay);
    table[kLogitLimit + x] = static_cast<std::uint16_t>(above);
    table[kLogitLimit - x] = static_cast<std::uint16_t>(65536 - above);
    decay = (decay * kStepDown + kOne / 2) >> 32U;
  }
  return table;
}

/// For the middle of each sixteenth of 2^12 the first log odds that reach it.
constexpr auto make_stretch(const std::array<std::uint16_t, 2 * kLogitLimit + 1>& squashed) {
  std::array<std::int16_t, kStretchSteps> table{};
  std::size_t at = 0;
  for (std::size_t step = 0; step < kStretchSteps; ++step) {
    while (at + 1 < squashed.size() && squashed[at] < step * 16 + 8) ++at;
    table[step] = static_cast<std::int16_t>(static_cast<int>(at) - kLogitLimit);
  }
  return table;
}

}  // namespace

constexpr std::array<std::uint16_t, 2 * kLogitLimit + 1> kSquash = make_squash();
constexpr std::array<std::int16_t, kStretchSteps> kStretch = make_stretch(kSquash);

}  // namespace cairn::logistic
