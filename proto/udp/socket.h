#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/common/result.h"
#include "core/common/time.h"
#include "proto/udp/endpoint.h"

namespace cairn::proto {

/// A UDP socket that never blocks, except in `wait`.
class UdpSocket {
 public:
  using Address = boost::asio::ip::udp::endpoint;

  /// conflict when the port is taken, unavailable when the host is not known.
  static Result<UdpSocket> bound_to(const UdpAddress& address);
  /// Any free port, of the same family as `peer`.
  static Result<UdpSocket> towards(const Address& peer);

  /// An error means that nothing left.
  Status send(std::span<const std::uint8_t> packet, const Address& to);

  struct Received {
    Address from;
    std::vector<std::uint8_t> packet;
  };
  /// The next packet, if one is here.
  std::optional<Received> receive();
  /// Returns when a packet is here or `timeout` is over. May run beside `send`.
  void wait(Duration timeout);
  [[nodiscard]] std::uint16_t port() const;

 private:
  UdpSocket() = default;
  static Result<UdpSocket> open(const Address& local);

  std::unique_ptr<boost::asio::io_context> io_ = std::make_unique<boost::asio::io_context>();
  boost::asio::ip::udp::socket socket_{*io_};
};

/// The first address of a host. unavailable when the name cannot be resolved now.
[[nodiscard]] Result<UdpSocket::Address> resolve_udp(const UdpAddress& address);

/// Time of the machine's monotonic clock.
[[nodiscard]] MonotonicTime udp_clock();

}  // namespace cairn::proto
