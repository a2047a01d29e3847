#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "proto/codec/frame.h"
#include "proto/udp/robot_end.h"
#include "proto/udp/server_end.h"

/// Both ends of the UDP carrier in virtual time, with the air between them in the test's hands.
namespace cairn::proto {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

inline UdpServerEnd::Address address(int host, std::uint16_t port = 4000) {
  const auto number = 0x0A000000U + static_cast<std::uint32_t>(host);
  return {boost::asio::ip::address_v4(number), port};
}

/// A Hello of that number, as the layer above says it outside of a session.
inline UdpBytes greeting(std::uint32_t number = 1) {
  FrameWriter frame({.direction = Direction::up, .session = 0, .number = number});
  frame.add(Hello{.robot = "rover", .site = "quarry", .boot = 7, .cell_size_mm = 125});
  return std::move(frame).finish();
}

inline const Secret& rover_key() {
  static const Secret key = Secret::random();
  return key;
}

class UdpEnds : public testing::Test {
 protected:
  struct Packet {
    UdpServerEnd::Address from;  ///< Upwards.
    UdpServerEnd::Address to;    ///< Downwards.
    UdpBytes bytes;
  };

  RobotKeys keys{{"rover", rover_key()}, {"scout", Secret::random()}};
  std::unique_ptr<UdpServerEnd> server = std::make_unique<UdpServerEnd>(keys);
  std::unique_ptr<UdpRobotEnd> robot = make_robot(1'000);
  UdpServerEnd::Address robot_at = address(1);
  MonotonicTime now = seconds(1'000);
  std::vector<Datagram> server_got;
  std::vector<UdpBytes> robot_got;
  std::string heard_last;  ///< Peer whose frame reached the server last.

  static std::unique_ptr<UdpRobotEnd> make_robot(std::uint64_t stamp) {
    return std::make_unique<UdpRobotEnd>(rover_key(), stamp);
  }
  /// What the robot has to say now, without its arriving.
  std::vector<UdpBytes> take_up() {
    std::vector<UdpBytes> packets;
    while (auto packet = robot->next_packet(now)) packets.push_back(std::move(*packet));
    return packets;
  }
  std::vector<UdpServerEnd::Outgoing> take_down() {
    std::vector<UdpServerEnd::Outgoing> packets;
    while (auto out = server->next_packet(now)) packets.push_back(std::move(*out));
    return packets;
  }
  void arrive_up(const UdpBytes& packet) { arrive_up(packet, robot_at); }
  void arrive_up(const UdpBytes& packet, const UdpServerEnd::Address& from) {
    auto frame = server->on_packet(packet, from, now);
    if (!frame) return;
    heard_last = frame->peer;
    server_got.push_back(std::move(*frame));
  }
  void arrive_down(const UdpBytes& packet) {
    if (auto frame = robot->on_packet(packet, now)) robot_got.push_back(std::move(*frame));
  }
  /// Lets everything through until nobody has anything to say at this moment.
  void settle() {
    for (bool moved = true; moved;) {
      moved = false;
      for (const UdpBytes& packet : take_up()) arrive_up(packet), moved = true;
      for (const auto& out : take_down()) {
        moved = true;
        if (out.to == robot_at) arrive_down(out.packet);
      }
    }
  }
  /// A session, shown by both ends.
  void connect() {
    (void)robot->send(greeting(), now);
    settle();
    now += UdpServerEnd::kAnswerWait;
    settle();
    now += UdpRobotEnd::kConfirmWait;
    settle();
    server_got.clear();
    robot_got.clear();
    ASSERT_TRUE(robot->has_session());
    ASSERT_TRUE(both_ways());
  }
  /// Whether frames go both ways just now.
  bool both_ways() {
    const UdpBytes up{1, static_cast<std::uint8_t>(++said_)};
    const UdpBytes down{2, static_cast<std::uint8_t>(said_)};
    (void)robot->send(up, now);
    settle();
    (void)server->send({heard_last, down}, now);
    settle();
    const bool went = !server_got.empty() && server_got.back().bytes == up && !robot_got.empty() &&
                      robot_got.back() == down;
    server_got.clear();
    robot_got.clear();
    return went;
  }

 private:
  unsigned said_ = 0;
};

}  // namespace cairn::proto
