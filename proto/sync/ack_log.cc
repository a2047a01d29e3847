#include "proto/sync/ack_log.h"

#include <algorithm>
#include <utility>

namespace cairn::proto {
namespace {

// Numbers up to cumulative + 1 + 64 are told apart; the one right after cumulative is not done.
constexpr std::uint64_t kReach = 65;

}  // namespace

void AckLog::done(std::uint32_t number, std::optional<MonotonicTime> arrived) {
  if (is_done(number)) return;
  if (arrived && number > newest_) {
    newest_ = number;
    arrived_ = arrived;
  }
  const std::uint64_t ahead = std::uint64_t{number} - ack_.cumulative;
  if (ahead > kReach) slide(ahead - kReach);
  const std::uint32_t place = number - ack_.cumulative;
  if (place == 1) {
    slide(1);
  } else {
    ack_.bitmap |= std::uint64_t{1} << (place - 2);
  }
}

Ack AckLog::tell(MonotonicTime now) {
  Ack ack = ack_;
  const auto arrived = std::exchange(arrived_, std::nullopt);
  if (!arrived) return ack;
  const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(now - *arrived).count();
  ack.delay_ms =
      static_cast<std::uint16_t>(std::clamp<std::int64_t>(waited, 0, Ack::kDelayUnknown - 1));
  return ack;
}

bool AckLog::is_done(std::uint32_t number) const {
  if (number <= ack_.cumulative) return true;
  const std::uint64_t ahead = std::uint64_t{number} - ack_.cumulative;
  if (ahead == 1 || ahead > kReach) return false;
  return ((ack_.bitmap >> (ahead - 2)) & 1U) != 0;
}

void AckLog::slide(std::uint64_t by) {
  ack_.cumulative += static_cast<std::uint32_t>(by);
  const std::uint64_t skipped = by - 1;
  ack_.bitmap = skipped < 64 ? ack_.bitmap >> skipped : 0;
  // Bit 0 now stands for cumulative + 1: what is done there belongs to cumulative.
  for (; (ack_.bitmap & 1U) != 0; ack_.bitmap >>= 1U) ++ack_.cumulative;
  ack_.bitmap >>= 1U;
}

}  // namespace cairn::proto
