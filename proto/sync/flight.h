#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/common/time.h"
#include "proto/codec/records.h"
#include "proto/sync/round_trip.h"

namespace cairn::proto {

/// What a sender knows about its ack-eliciting frames under way: which were acknowledged, which are
/// lost (three newer ones acknowledged, or silence: RFC 9002 §6), the round-trip time, and how many
/// evidence frames may be under way at once. A number is used once, so every acknowledgement is an
/// honest round-trip sample.
class Flight {
 public:
  /// [frames] The receiver tells apart 64 numbers beyond the first gap; a frame this far behind the
  /// newest is given up, so that a sliding window can never pass for an acknowledgement.
  static constexpr std::uint32_t kReach = 60;
  /// [frames] New evidence waits before it would push an unacknowledged frame out of reach.
  static constexpr std::uint32_t kEvidenceReach = 52;
  static constexpr int kPacketThreshold = 3;
  static constexpr int kFirstWindow = 8;
  static constexpr int kLeastWindow = 2;

  /// Requires: window_frames ≥ kLeastWindow.
  explicit Flight(int window_frames);

  /// The next frame's number. Frames that it puts out of reach are appended to `lost`.
  std::uint32_t next_number(std::vector<std::uint32_t>& lost);
  /// The frame numbered last asks for an acknowledgement.
  void sent(std::uint32_t number, bool evidence, MonotonicTime now);

  struct News {
    std::vector<std::uint32_t> acked;
    std::vector<std::uint32_t> lost;
  };
  /// An acknowledgement of numbers never sent is ignored whole.
  News on_ack(const Ack& ack, MonotonicTime now);
  /// Frames whose time is over. Each call that finds some doubles the patience until something is
  /// acknowledged, and halves the window.
  std::vector<std::uint32_t> on_time(MonotonicTime now);
  /// Everything under way counts as lost and patience is fresh: the link was away.
  std::vector<std::uint32_t> lose_all();
  /// A new session: numbers begin at 1 again, nothing is under way.
  void reset();

  /// Of the frame numbered last; 0 before the first.
  [[nodiscard]] std::uint32_t last_number() const { return last_number_; }
  [[nodiscard]] bool evidence_may_go() const;
  /// When `on_time` has something to say; nullopt when nothing is under way.
  [[nodiscard]] std::optional<MonotonicTime> due() const;
  [[nodiscard]] Duration patience() const;
  [[nodiscard]] const RoundTrip& round_trip() const { return round_trip_; }

 private:
  struct Sent {
    MonotonicTime at{};
    bool evidence = false;
    bool lost = false;  ///< Judged lost; still listened for as long as it is within reach.
    int newer_acked = 0;
  };
  using Frames = std::map<std::uint32_t, Sent>;

  void acknowledge(Frames::iterator frame);
  void lose(Sent& frame);

  int most_window_;
  int window_ = kFirstWindow;
  int evidence_under_way_ = 0;
  int backoff_ = 0;  ///< Doublings of the timeout.
  std::uint32_t last_number_ = 0;
  Frames frames_;  ///< [Limit: ≤ kReach]
  RoundTrip round_trip_;
};

}  // namespace cairn::proto
