#include "proto/udp/socket.h"

#include <poll.h>

#include <algorithm>
#include <array>

#include "proto/udp/packet.h"

namespace cairn::proto {

namespace ip = boost::asio::ip;
using boost::system::error_code;

namespace {

/// [bytes] Room for a burst of several robots at the server.
constexpr int kReceiveBufferBytes = 1 << 20;
constexpr std::size_t kMaxPacketBytes = 2048;

Error no_socket(const error_code& error, const UdpSocket::Address& local) {
  const std::string where = local.address().to_string() + ":" + std::to_string(local.port());
  if (error == boost::asio::error::address_in_use) {
    return {ErrorCode::conflict,
            "UDP port " + where + " is taken: stop the other program or choose another port"};
  }
  return {ErrorCode::io, "cannot open UDP " + where + ": " + error.message()};
}

}  // namespace

Result<UdpSocket::Address> resolve_udp(const UdpAddress& address) {
  boost::asio::io_context io;
  error_code error;
  const auto found =
      ip::udp::resolver(io).resolve(address.host, std::to_string(address.port), error);
  if (error || found.empty()) {
    return Error{ErrorCode::unavailable,
                 "host '" + address.host + "' of the UDP address is not known (" + error.message() +
                     "): check the name or give its address"};
  }
  return found.begin()->endpoint();
}

MonotonicTime udp_clock() {
  return std::chrono::duration_cast<MonotonicTime>(
      std::chrono::steady_clock::now().time_since_epoch());
}

Result<UdpSocket> UdpSocket::open(const Address& local) {
  UdpSocket socket;
  error_code error;
  socket.socket_.open(local.protocol(), error);
  if (!error) socket.socket_.bind(local, error);
  if (!error) socket.socket_.non_blocking(true, error);
  if (error) return no_socket(error, local);
  // Less room than asked for is a slower server, not a broken one.
  socket.socket_.set_option(ip::udp::socket::receive_buffer_size(kReceiveBufferBytes), error);
  return socket;
}

Result<UdpSocket> UdpSocket::bound_to(const UdpAddress& address) {
  const auto local = resolve_udp(address);
  if (!local) return local.error();
  return open(*local);
}

Result<UdpSocket> UdpSocket::towards(const Address& peer) {
  return open(Address(peer.protocol(), 0));
}

Status UdpSocket::send(std::span<const std::uint8_t> packet, const Address& to) {
  error_code error;
  socket_.send_to(boost::asio::buffer(packet.data(), packet.size()), to, 0, error);
  if (!error) return {};
  return Error{ErrorCode::unavailable,
               "UDP to " + to.address().to_string() + ": " + error.message()};
}

std::optional<UdpSocket::Received> UdpSocket::receive() {
  std::array<std::uint8_t, kMaxPacketBytes> buffer{};
  Received received;
  // Errors of one packet (refused, too long) say nothing about the next.
  constexpr int kMostErrors = 16;
  for (int tries = 0; tries < kMostErrors; ++tries) {
    error_code error;
    const std::size_t size =
        socket_.receive_from(boost::asio::buffer(buffer), received.from, 0, error);
    if (error == boost::asio::error::would_block) return std::nullopt;
    if (error) continue;
    received.packet.assign(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size));
    return received;
  }
  return std::nullopt;
}

void UdpSocket::wait(Duration timeout) {
  pollfd waiting{.fd = socket_.native_handle(), .events = POLLIN, .revents = 0};
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(std::max(timeout, Duration{}));
  (void)poll(&waiting, 1, static_cast<int>(left.count()));
}

std::uint16_t UdpSocket::port() const {
  error_code error;
  return socket_.local_endpoint(error).port();
}

}  // namespace cairn::proto
