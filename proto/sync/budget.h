#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "core/common/result.h"
#include "core/common/time.h"

namespace cairn::proto {

/// Why a frame is sent, most urgent first. A frame with several contents counts as the last of
/// them: what it is long for.
enum class Traffic : std::uint8_t {
  control,  ///< Commands, reports on them, acknowledgements, Welcome: never waits.
  pose,
  map,  ///< Evidence up, the long-term map down.
};
inline constexpr std::size_t kTrafficKinds = 3;
using TrafficBytes = std::array<std::uint64_t, kTrafficKinds>;

struct BudgetConfig {
  /// [bit/s] IP bits a direction of the link is trusted to carry, whatever seems to happen.
  double floor_bit_s = 2'400.0;
  /// [bit/s] What it begins with, before anything was measured.
  double first_bit_s = 9'600.0;
  /// [bit/s] Never more than this, however well it goes: what the operator pays or leaves to us.
  double ceiling_bit_s = 100e6;
};
/// invalid_argument unless 0 < floor ≤ first ≤ ceiling (a first outside is moved by `Budget`).
[[nodiscard]] Status validate(const BudgetConfig& config);

/// How many bytes one end may put on the link: a token bucket whose rate follows what the link
/// shows. The rate grows while it is used up and acknowledgements come as fast as on an idle link.
/// When they come later there is a queue, and we made it: then their pace is what the link carries,
/// the rate goes below that, and the map pauses until the queue is gone. Loss alone does not shrink
/// it (a radio loses packets at any rate) unless more than half is lost or nothing comes at all. In
/// the manner of delay-based congestion control (LEDBAT, RFC 6817; BBR, ACM Queue 14:5; Copa, NSDI
/// 2018).
///
/// Strict priority: control may always be sent and is paid for afterwards; a pose may overdraw by
/// kPoseOverdraft; the map waits until the account is in credit. Neither is starved: the longest
/// waits are kPosePatience and kMapPatience.
class Budget {
 public:
  /// [bytes] The longest frame with the headers of any carrier: nothing can be sent by half.
  static constexpr double kLongestPacket = 1'300.0;
  /// A queue this long (beyond one packet) is one that we made.
  static constexpr Duration kQueueTarget = std::chrono::milliseconds(150);
  static constexpr Duration kPoseOverdraft = std::chrono::seconds(1);
  static constexpr Duration kMostOverdraft = std::chrono::seconds(2);
  static constexpr Duration kPosePatience = std::chrono::seconds(3);
  static constexpr Duration kMapPatience = std::chrono::seconds(10);
  /// The idle round trip is the least of this long; links change.
  static constexpr Duration kMemory = std::chrono::seconds(30);
  static constexpr double kMostLoss = 0.5;
  /// What may leave at once after a pause, beyond one packet: senders are not woken for each.
  static constexpr Duration kBurst = std::chrono::milliseconds(25);

  explicit Budget(const BudgetConfig& config = {});

  /// Whether a frame of this kind may leave now. Being refused counts as the rate being used up.
  [[nodiscard]] bool may_send(Traffic kind, MonotonicTime now);
  /// When it may; `now` when it may at once.
  [[nodiscard]] MonotonicTime due(Traffic kind, MonotonicTime now) const;
  void sent(Traffic kind, std::size_t bytes, MonotonicTime now);

  /// [bytes] Sent so far, of all kinds.
  [[nodiscard]] std::uint64_t total() const;
  /// A frame as it was sent.
  struct Mark {
    std::size_t bytes = 0;
    std::uint64_t total = 0;  ///< `total` once it was sent.
  };
  /// An acknowledgement: how long after the newest frame it names was sent, and which that was.
  void on_round_trip(Duration round_trip, const Mark& frame, MonotonicTime now);
  /// What became of frames. `found_again` of those acknowledged had been judged lost before: what
  /// is repeated early, because somebody waits for it, is mostly not lost.
  void on_fate(std::size_t acknowledged, std::size_t lost, std::size_t found_again = 0);
  /// Frames timed out one after the other and nothing was acknowledged: the link may be away.
  void on_silence();
  /// The peer is heard again: it is the link that it was, until a queue says otherwise.
  void on_return();

  [[nodiscard]] double rate_bit_s() const { return rate_ * 8.0; }
  /// Estimated wait in the queues of the way, beyond the idle round trip.
  [[nodiscard]] Duration queue() const { return queue_; }
  /// [0 … 1] Share of frames lost, lately.
  [[nodiscard]] double loss() const { return loss_; }
  [[nodiscard]] const TrafficBytes& sent_bytes() const { return sent_bytes_; }

 private:
  [[nodiscard]] double balance_at(MonotonicTime now) const;
  [[nodiscard]] double least_balance(Traffic kind) const;
  [[nodiscard]] double depth() const;
  [[nodiscard]] Duration packet_time() const;
  [[nodiscard]] Duration target() const;
  [[nodiscard]] std::optional<double> capacity() const;
  void note_excess(Duration excess, const Mark& frame, MonotonicTime now);
  /// The quickest round trip lately, and how long its frame was.
  struct Idle {
    Duration round_trip{};
    std::size_t bytes = 0;
  };
  void note_idle(const Idle& seen, MonotonicTime now);
  [[nodiscard]] Idle idle() const;
  void grow(MonotonicTime now);
  /// The map waits this long: what is in the queue leaves meanwhile.
  void pause(Duration length, MonotonicTime now);
  void shrink(const Mark& newest, MonotonicTime now);
  void set_rate(double bytes_s);

  BudgetConfig config_;
  double rate_;  ///< [bytes/s]
  double balance_ = kLongestPacket;
  MonotonicTime balance_at_{};
  std::array<MonotonicTime, kTrafficKinds> sent_at_{};
  bool used_up_ = false;         ///< Something had to wait since the last step.
  bool starting_ = true;         ///< Grows boldly until a queue shows.
  std::size_t steps_ = 0;        ///< Up, since a queue was seen.
  double carried_ = 0.0;         ///< [bytes/s] Through the last queue that was seen; 0 = none yet.
  double before_silence_ = 0.0;  ///< [bytes/s] The rate then; 0 = there is none.
  MonotonicTime changed_at_{};   ///< What was sent before tells of another rate.
  std::array<std::optional<Idle>, 2> idle_;  ///< Of this and of the last half memory.
  MonotonicTime idle_turn_{};
  std::array<Duration, 3> recent_{};  ///< Excess of the last round trips: jitter must not count.
  std::size_t samples_ = 0;
  Duration queue_{};
  struct Arrival {
    MonotonicTime at{};
    std::uint64_t total = 0;
  };
  static constexpr std::size_t kMaxArrivals = 32;
  std::deque<Arrival> busy_;  ///< While there is a queue. [Limit: ≤ kMaxArrivals]
  double loss_ = 0.0;
  TrafficBytes sent_bytes_{};
};

}  // namespace cairn::proto
