#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "proto/carrier.h"
#include "proto/codec/frame.h"
#include "proto/udp/endpoint.h"
#include "proto/udp/robot_end.h"
#include "proto/udp/socket.h"

namespace cairn::proto {

/// [bytes] IPv4 20, UDP 8, head 8, tag 16, less what stays at home of a frame.
inline constexpr std::size_t kUdpOverheadBytes = 28 + kDataBytes - kFrameEndsBytes;

/// A robot's end of the UDP carrier. Sends from any free port, so its own address may change as it
/// likes; the server's name is looked up again when no answer comes.
class UdpRobotCarrier final : public Carrier {
 public:
  /// The server need not run yet, but its name must be known. `key`: this robot's.
  static Result<std::unique_ptr<UdpRobotCarrier>> create(const UdpAddress& server,
                                                         const Secret& key);

  Status send(const Datagram& frame) override;
  Result<std::optional<Datagram>> receive(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::size_t overhead_bytes() const override { return kUdpOverheadBytes; }

 private:
  /// Every so many tries of a set-up the server's name is looked up anew.
  static constexpr int kTriesPerLookup = 8;

  UdpRobotCarrier(UdpAddress server, UdpSocket::Address at, UdpSocket socket, const Secret& key);
  void flush(MonotonicTime now);
  void look_up_again();

  const UdpAddress server_;
  std::mutex mutex_;  ///< Guards what follows; the socket's `wait` needs none.
  UdpSocket::Address at_;
  UdpSocket socket_;
  UdpRobotEnd end_;
  int looked_up_at_ = 0;  ///< [tries]
};

}  // namespace cairn::proto
