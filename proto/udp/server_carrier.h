#pragma once

#include <memory>
#include <mutex>

#include "proto/carrier.h"
#include "proto/udp/endpoint.h"
#include "proto/udp/robot_carrier.h"
#include "proto/udp/server_end.h"
#include "proto/udp/socket.h"

namespace cairn::proto {

/// The server's end of the UDP carrier. `Datagram::peer` is the robot's id, proven by its key.
class UdpServerCarrier final : public Carrier {
 public:
  static Result<std::unique_ptr<UdpServerCarrier>> create(const UdpAddress& listen,
                                                          const RobotKeys& keys);

  Status send(const Datagram& frame) override;
  Result<std::optional<Datagram>> receive(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::size_t overhead_bytes() const override { return kUdpOverheadBytes; }
  [[nodiscard]] std::optional<std::string> proven_robot(const std::string& peer) const override {
    return UdpPeer::of(peer).robot;
  }
  [[nodiscard]] std::uint16_t port() const { return socket_.port(); }

 private:
  UdpServerCarrier(UdpSocket socket, const RobotKeys& keys);
  void flush(MonotonicTime now);

  std::mutex mutex_;  ///< Guards what follows; the socket's `wait` needs none.
  UdpSocket socket_;
  UdpServerEnd end_;
};

}  // namespace cairn::proto
