// Datagrams of anybody, at both ends of the UDP carrier.

#include <sodium.h>

#include "proto/udp/robot_end.h"
#include "proto/udp/server_end.h"
#include "tests/fuzz/input.h"

using namespace cairn;

namespace {

/// The same key and the same random numbers each time: a run can be repeated.
const proto::Secret& key() {
  static const proto::Secret fixed = [] {
    (void)sodium_init();
    return proto::Secret::random();
  }();
  return fixed;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  proto::UdpServerEnd server({{"rover", key()}});
  proto::UdpRobotEnd robot(key(), 1'000);
  const proto::UdpServerEnd::Address at(boost::asio::ip::address_v4::loopback(), 4000);
  MonotonicTime now = std::chrono::seconds(1);
  (void)robot.send(std::vector<std::uint8_t>{1}, now);
  while (!input.empty()) {
    now += std::chrono::milliseconds(input.byte());
    const auto packet = input.stretch();
    fuzz::require(!server.on_packet(packet, at, now));
    fuzz::require(!robot.on_packet(packet, now));
    while (server.next_packet(now)) {
    }
    while (robot.next_packet(now)) {
    }
  }
  fuzz::require(server.sessions() == 0);
  return 0;
}
