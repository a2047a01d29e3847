#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/common/time.h"
#include "proto/codec/records.h"
#include "proto/sync/budget.h"
#include "proto/sync/round_trip.h"

namespace cairn::proto {

/// What a sender knows about its ack-eliciting frames under way: which were acknowledged, which are
/// lost (three newer ones acknowledged, or silence: RFC 9002 §6), and the round-trip time. A number
/// is used once, so every acknowledgement is an honest round-trip sample. How fast frames may
/// follow each other is the Budget's business; only after silence Flight lets through ever fewer,
/// so that little is said to a link that is away.
class Flight {
 public:
  /// [frames] The receiver tells apart 64 numbers beyond the first gap; a frame this far behind the
  /// newest is given up, so that a sliding window can never pass for an acknowledgement.
  static constexpr std::uint32_t kReach = 60;
  /// [frames] New evidence waits before it would push an unacknowledged frame out of reach.
  static constexpr std::uint32_t kEvidenceReach = 52;
  static constexpr int kPacketThreshold = 3;
  /// [frames] With evidence under way, after the first timeout; half of it after the next.
  static constexpr int kSilentWindow = 8;
  /// An urgent frame is repeated after this share of the round trip, so often before it waits as
  /// long as others: twice the bytes of something short for half the delay of its loss.
  static constexpr double kUrgentShare = 0.6;
  static constexpr Duration kLeastUrgentWait = std::chrono::milliseconds(60);
  static constexpr Duration kMostUrgentWait = std::chrono::milliseconds(500);
  static constexpr int kUrgentTries = 5;

  enum class Load : std::uint8_t {
    evidence,  ///< Or the long-term map: long frames, many of them.
    urgent,    ///< Short, and somebody waits for it.
    other,
  };

  /// The next frame's number. Frames that it puts out of reach are appended to `lost`.
  std::uint32_t next_number(std::vector<std::uint32_t>& lost);
  [[nodiscard]] std::uint32_t last_number() const { return last_number_; }
  /// The frame numbered last asks for an acknowledgement.
  void sent(std::uint32_t number, Load load, const Budget::Mark& mark, MonotonicTime now);

  struct News {
    std::vector<std::uint32_t> acked;
    std::vector<std::uint32_t> lost;
    std::size_t found_again = 0;  ///< Of `acked`: had been judged lost.
    /// Of the newest frame, newly acknowledged, without the time that the peer took for it; none
    /// when the peer did not say how long that was.
    std::optional<Duration> round_trip;
    Budget::Mark newest;  ///< That frame.
  };
  /// An acknowledgement of numbers never sent is ignored whole.
  News on_ack(const Ack& ack, MonotonicTime now);
  /// Frames whose time is over. Each call that finds some that were not urgent doubles the patience
  /// until something is acknowledged.
  std::vector<std::uint32_t> on_time(MonotonicTime now);
  /// How often in a row it did.
  [[nodiscard]] int timeouts() const { return backoff_; }
  /// [bytes] Under way and not judged lost.
  [[nodiscard]] std::size_t bytes_under_way() const;
  /// Everything under way counts as lost and patience is fresh: the link was away.
  std::vector<std::uint32_t> lose_all();
  /// A new session: numbers begin at 1 again, nothing is under way.
  void reset();

  [[nodiscard]] bool evidence_may_go() const;
  /// When `on_time` has something to say; nullopt when nothing is under way.
  [[nodiscard]] std::optional<MonotonicTime> due() const;
  [[nodiscard]] Duration patience() const;
  [[nodiscard]] const RoundTrip& round_trip() const { return round_trip_; }

 private:
  struct Sent {
    MonotonicTime at{};
    Load load = Load::other;
    Budget::Mark mark;
    bool lost = false;  ///< Judged lost; still listened for as long as it is within reach.
    int newer_acked = 0;
  };
  using Frames = std::map<std::uint32_t, Sent>;

  void acknowledge(Frames::iterator frame);
  void measure(const Frames::value_type& newest, const Ack& ack, MonotonicTime now, News& news);
  void lose(Sent& frame);
  [[nodiscard]] MonotonicTime due(const Sent& frame) const;
  [[nodiscard]] Duration urgent_patience() const;

  int evidence_under_way_ = 0;
  int backoff_ = 0;       ///< Doublings of the timeout.
  int urgent_tries_ = 0;  ///< Urgent frames judged lost in a row.
  std::uint32_t last_number_ = 0;
  std::uint32_t newest_acked_ = 0;
  Frames frames_;  ///< [Limit: ≤ kReach]
  RoundTrip round_trip_;
};

}  // namespace cairn::proto
