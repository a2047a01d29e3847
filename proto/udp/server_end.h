#pragma once

#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/common/result.h"
#include "core/common/time.h"
#include "proto/carrier.h"
#include "proto/udp/keys.h"
#include "proto/udp/noise.h"
#include "proto/udp/packet.h"
#include "proto/udp/session.h"

namespace cairn::proto {

/// So many answers to packets that prove nothing leave in a second.
class AnswerBudget {
 public:
  static constexpr double kPerSecond = 50.0;
  static constexpr double kBurst = 50.0;
  [[nodiscard]] bool take(MonotonicTime now);

 private:
  double left_ = kBurst;
  MonotonicTime at_{};
};

/// One running agent of a robot, as `Datagram::peer` names it: two agents may hold one key.
struct UdpPeer {
  std::string robot;
  std::uint32_t agent = 0;

  [[nodiscard]] std::string name() const;
  /// Requires: made by `name`.
  [[nodiscard]] static UdpPeer of(const std::string& name);
};

/// The server's end of the UDP carrier, as a state machine without clock or socket. Keeps state for
/// the robots of its key file alone: whatever a stranger sends costs one failed authentication.
/// `Datagram::peer` is a UdpPeer's name; its robot is proven by the key.
class UdpServerEnd {
 public:
  using Address = boost::asio::ip::udp::endpoint;

  /// [sessions] Of one robot, that have shown their keys.
  static constexpr std::size_t kMaxSessions = 4;
  /// A session unheard for this long goes when a newer one has shown its keys.
  static constexpr Duration kLinger = std::chrono::seconds(30);
  /// The answer to a set-up waits this long for a frame to ride along.
  static constexpr Duration kAnswerWait = std::chrono::milliseconds(50);
  /// The answer is repeated this often at most, when the set-up comes again.
  static constexpr Duration kRepeatWait = std::chrono::milliseconds(100);
  /// An answer is at most this many times as long as the packet that asked for it.
  static constexpr std::size_t kMostGrowth = 3;
  /// [frames] For a robot that has not shown its keys yet.
  static constexpr std::size_t kMaxWaiting = 8;
  /// [packets] To the wire; more are dropped, the oldest first.
  static constexpr std::size_t kMaxQueued = 4096;

  explicit UdpServerEnd(const RobotKeys& keys);

  /// unavailable while the robot has no session.
  Status send(const Datagram& frame, MonotonicTime now);
  /// The frame that the packet brought, if any.
  std::optional<Datagram> on_packet(std::span<const std::uint8_t> packet, const Address& from,
                                    MonotonicTime now);

  struct Outgoing {
    Address to;
    UdpBytes packet;
  };
  std::optional<Outgoing> next_packet(MonotonicTime now);
  [[nodiscard]] MonotonicTime next_due(MonotonicTime now) const;

  /// Packets that were not authentic, too old, or of no session.
  [[nodiscard]] std::uint64_t refused_packets() const { return refused_; }
  /// [sessions] Known now, of all robots.
  [[nodiscard]] std::size_t sessions() const { return by_name_.size(); }

 private:
  struct Session {
    UdpSession keys;
    std::uint32_t agent = 0;
    Address at;
    MonotonicTime heard_at{};
  };
  /// A set-up that was asked for by a genuine packet and not yet confirmed by another.
  struct Pending {
    UdpBytes asked;  ///< The packet.
    Address at;
    NoiseHandshake handshake;
    std::uint32_t name = 0;
    std::uint32_t robot_session = 0;
    std::uint32_t agent = 0;
    MonotonicTime begun{};
    std::optional<UdpSession> keys = {};  ///< Once answered.
    UdpBytes answer = {};
    MonotonicTime answered_at{};
    std::deque<UdpBytes> waiting = {};  ///< Frames. [Limit: ≤ kMaxWaiting]
  };
  struct Robot {
    std::string id;
    Secret key;
    std::uint64_t newest_stamp = 0;
    std::optional<Pending> pending;
    std::vector<Session> sessions;  ///< [Limit: ≤ kMaxSessions]
  };
  struct KeyIdHash {
    std::size_t operator()(const KeyId& id) const;
  };

  std::optional<Datagram> on_first(std::span<const std::uint8_t> packet, const Address& from,
                                   MonotonicTime now);
  std::optional<Datagram> begin(Robot& robot, Pending pending, const UdpBytes& greeting,
                                MonotonicTime now);
  void repeat_answer(Robot& robot, const Address& from, MonotonicTime now);
  void say_stale(const Robot& robot, const NoiseHandshake& handshake, std::uint32_t robot_session,
                 const Address& to, MonotonicTime now);
  void answer(Robot& robot, std::span<const std::uint8_t> frame, MonotonicTime now);
  std::optional<Datagram> on_data(std::span<const std::uint8_t> packet, const Address& from,
                                  MonotonicTime now);
  void confirm(Robot& robot, MonotonicTime now);
  void forget(std::uint32_t name) { by_name_.erase(name); }
  static Session* newest_session(Robot& robot, std::uint32_t agent);
  std::uint32_t free_name() const;
  void queue(const Address& to, UdpBytes packet);
  std::optional<Datagram> refuse();

  std::map<std::string, Robot> robots_;  ///< Fixed: one for each key.
  std::unordered_map<KeyId, Robot*, KeyIdHash> by_key_;
  /// [Limit: ≤ (kMaxSessions + 1) · keys]
  std::unordered_map<std::uint32_t, Robot*> by_name_;
  std::vector<Robot*> unanswered_;  ///< Whose pending set-up waits for a frame to ride along.
  std::deque<Outgoing> outbox_;     ///< [Limit: ≤ kMaxQueued]
  AnswerBudget budget_;
  std::uint64_t refused_ = 0;
};

}  // namespace cairn::proto
