#include "proto/udp/robot_carrier.h"

#include <chrono>
#include <utility>

#include "proto/udp/keys.h"

namespace cairn::proto {
namespace {

std::uint64_t wall_ms() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(since).count();
  return ms > 0 ? static_cast<std::uint64_t>(ms) : 1;
}

}  // namespace

UdpRobotCarrier::UdpRobotCarrier(UdpAddress server, UdpSocket::Address at, UdpSocket socket,
                                 const Secret& key)
    : server_(std::move(server)),
      at_(std::move(at)),
      socket_(std::move(socket)),
      end_(key, wall_ms()) {}

Result<std::unique_ptr<UdpRobotCarrier>> UdpRobotCarrier::create(const UdpAddress& server,
                                                                 const Secret& key) {
  if (sodium_init() < 0) return Error{ErrorCode::io, "the system gives no random numbers"};
  if (server.port == 0) {
    return Error{ErrorCode::invalid_argument, "the server's UDP port is missing: udp://HOST:PORT"};
  }
  const auto at = resolve_udp(server);
  if (!at) return at.error();
  auto socket = UdpSocket::towards(*at);
  if (!socket) return socket.error();
  return std::unique_ptr<UdpRobotCarrier>(
      new UdpRobotCarrier(server, *at, std::move(socket).value(), key));
}

Status UdpRobotCarrier::send(const Datagram& frame) {
  if (Status size = check_frame_size(frame.bytes.size()); !size) return size;
  const std::lock_guard lock(mutex_);
  const MonotonicTime now = udp_clock();
  Status sent = end_.send(frame.bytes, now);
  flush(now);
  return sent;
}

Result<std::optional<Datagram>> UdpRobotCarrier::receive(std::chrono::milliseconds timeout) {
  const MonotonicTime deadline = udp_clock() + timeout;
  for (;;) {
    Duration wait{};
    {
      const std::lock_guard lock(mutex_);
      while (const auto received = socket_.receive()) {
        auto frame = end_.on_packet(received->packet, udp_clock());
        if (frame) return std::optional(Datagram{"", std::move(*frame)});
      }
      const MonotonicTime now = udp_clock();
      flush(now);
      if (now >= deadline) return std::optional<Datagram>();
      wait = std::min(deadline, end_.next_due(now)) - now;
    }
    socket_.wait(wait);
  }
}

void UdpRobotCarrier::flush(MonotonicTime now) {
  // The layer above repeats what does not leave.
  while (const auto packet = end_.next_packet(now)) (void)socket_.send(*packet, at_);
  if (end_.tries() < looked_up_at_) looked_up_at_ = 0;
  if (end_.tries() >= looked_up_at_ + kTriesPerLookup) look_up_again();
}

void UdpRobotCarrier::look_up_again() {
  looked_up_at_ = end_.tries();
  const auto at = resolve_udp(server_);
  if (at && at->protocol() == at_.protocol()) at_ = *at;
}

}  // namespace cairn::proto
