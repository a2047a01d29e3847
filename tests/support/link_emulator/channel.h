#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <queue>
#include <random>
#include <utility>
#include <vector>

/// An emulated radio link: what one direction does to packets, without clock or device.
namespace cairn::test {

using LinkTime = std::chrono::nanoseconds;  ///< Since an arbitrary start.

/// What one direction of a link does.
struct ChannelConfig {
  double rate_bit_s = 0.0;                   ///< 0: as fast as packets come.
  LinkTime queue = std::chrono::seconds(1);  ///< Tail drop beyond this much at the rate.
  LinkTime delay{};                          ///< After the last bit has left.
  LinkTime jitter{};                         ///< Uniform, added to the delay.
  bool reorder = false;                      ///< Jitter may turn the order round.
  double loss = 0.0;                         ///< Of each packet by itself [0 … 1].
  double burst_begin = 0.0;                  ///< Gilbert: a packet begins a burst of losses …
  double burst_end = 1.0;                    ///< … and one of a burst is its last.
  double duplicate = 0.0;                    ///< [0 … 1]
  double bit_error = 0.0;                    ///< Each bit by itself; damaged packets arrive.
  std::vector<std::pair<LinkTime, LinkTime>> outages = {};  ///< [from, to): all is lost.
};

struct PacketCount {
  std::uint64_t packets = 0;
  std::uint64_t bytes = 0;
  void add(std::size_t size) {
    ++packets;
    bytes += size;
  }
};

struct ChannelCounters {
  PacketCount offered;  ///< What the sender put on the link: this is what it costs.
  PacketCount delivered;
  PacketCount lost;
  PacketCount queue_dropped;
  PacketCount outage_dropped;
  PacketCount duplicated;
  PacketCount damaged;
  LinkTime longest_queue{};
  LinkTime first_offered = LinkTime::max();
};
[[nodiscard]] nlohmann::json to_json(const ChannelCounters& counters);

/// One direction. The same seed and the same packets at the same times give the same fate.
class Channel {
 public:
  using Packet = std::vector<std::uint8_t>;

  Channel(std::uint64_t seed, ChannelConfig config) : random_(seed), config_(std::move(config)) {}

  void offer(Packet packet, LinkTime now);
  /// The next packet that has arrived by `now`.
  std::optional<Packet> receive(LinkTime now);
  /// When `receive` may have something; nullopt when nothing is under way.
  [[nodiscard]] std::optional<LinkTime> next_arrival() const;

  /// Takes effect on packets offered from now on.
  void set(ChannelConfig config) { config_ = std::move(config); }
  [[nodiscard]] const ChannelConfig& config() const { return config_; }
  [[nodiscard]] const ChannelCounters& counters() const { return counters_; }

 private:
  struct Flying {
    LinkTime at;
    std::uint64_t order;
    Packet packet;
    bool operator<(const Flying& other) const {
      return std::pair(at, order) > std::pair(other.at, other.order);
    }
  };

  bool chance(double p) { return p > 0.0 && std::bernoulli_distribution(p)(random_); }
  [[nodiscard]] bool out(LinkTime at) const;
  bool lose();
  void damage(Packet& packet);
  LinkTime arrival(LinkTime sent);

  std::mt19937_64 random_;
  ChannelConfig config_;
  ChannelCounters counters_;
  LinkTime free_at_{};  ///< When the last packet offered so far has left.
  LinkTime last_arrival_{};
  bool in_burst_ = false;
  std::uint64_t offered_ = 0;
  std::priority_queue<Flying> flying_;
};

}  // namespace cairn::test
