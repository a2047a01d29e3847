#include "proto/udp/replay_window.h"

#include <algorithm>
#include <cassert>

namespace cairn::proto {
namespace {

constexpr std::uint64_t kTurn = std::uint64_t{1} << 24U;

}  // namespace

std::uint64_t ReplayWindow::expand(std::uint32_t low) const {
  const std::uint64_t candidate = (next_ & ~(kTurn - 1)) | (low & (kTurn - 1));
  if (candidate + kTurn / 2 < next_) return candidate + kTurn;
  if (candidate > next_ + kTurn / 2 && candidate >= kTurn) return candidate - kTurn;
  return candidate;
}

bool ReplayWindow::is_new(std::uint64_t counter) const {
  if (counter >= next_) return true;
  // One word less than the window: that word is the one being filled.
  if (next_ - counter > kBits - kWordBits) return false;
  return (seen_[word(counter)] & bit(counter)) == 0;
}

bool ReplayWindow::accept(std::uint64_t counter) {
  assert(is_new(counter));
  const bool highest = counter >= next_;
  if (highest) {
    const std::uint64_t from = next_ == 0 ? 0 : (next_ - 1) / kWordBits + 1;
    const std::uint64_t to = counter / kWordBits;
    for (std::uint64_t i = std::max(from, to < kWords ? 0 : to - kWords + 1); i <= to; ++i) {
      seen_[i % kWords] = 0;
    }
    next_ = counter + 1;
  }
  seen_[word(counter)] |= bit(counter);
  return highest;
}

}  // namespace cairn::proto
