#include "proto/udp/server_carrier.h"

#include <algorithm>
#include <utility>

namespace cairn::proto {

UdpServerCarrier::UdpServerCarrier(UdpSocket socket, const RobotKeys& keys)
    : socket_(std::move(socket)), end_(keys) {}

Result<std::unique_ptr<UdpServerCarrier>> UdpServerCarrier::create(const UdpAddress& listen,
                                                                   const RobotKeys& keys) {
  if (sodium_init() < 0) return Error{ErrorCode::io, "the system gives no random numbers"};
  auto socket = UdpSocket::bound_to(listen);
  if (!socket) return socket.error();
  return std::unique_ptr<UdpServerCarrier>(new UdpServerCarrier(std::move(socket).value(), keys));
}

Status UdpServerCarrier::send(const Datagram& frame) {
  if (Status size = check_frame_size(frame.bytes.size()); !size) return size;
  const std::lock_guard lock(mutex_);
  const MonotonicTime now = udp_clock();
  Status sent = end_.send(frame, now);
  flush(now);
  return sent;
}

Result<std::optional<Datagram>> UdpServerCarrier::receive(std::chrono::milliseconds timeout) {
  const MonotonicTime deadline = udp_clock() + timeout;
  for (;;) {
    Duration wait{};
    {
      const std::lock_guard lock(mutex_);
      while (const auto received = socket_.receive()) {
        auto frame = end_.on_packet(received->packet, received->from, udp_clock());
        flush(udp_clock());
        if (frame) return std::optional(std::move(*frame));
      }
      const MonotonicTime now = udp_clock();
      flush(now);
      if (now >= deadline) return std::optional<Datagram>();
      wait = std::min(deadline, end_.next_due(now)) - now;
    }
    socket_.wait(wait);
  }
}

void UdpServerCarrier::flush(MonotonicTime now) {
  // The layer above repeats what does not leave.
  while (const auto out = end_.next_packet(now)) (void)socket_.send(out->packet, out->to);
}

}  // namespace cairn::proto
