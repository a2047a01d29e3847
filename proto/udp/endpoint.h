#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/common/result.h"

namespace cairn::proto {

inline constexpr std::uint16_t kDefaultUdpPort = 8643;

/// Where server and robots meet over UDP. A robot names the server's host; a server names the
/// address it listens on.
struct UdpAddress {
  std::string host;
  std::uint16_t port = kDefaultUdpPort;  ///< A server's 0: any free one.
  friend bool operator==(const UdpAddress&, const UdpAddress&) = default;
};

/// Whether an address of the operator means this carrier.
[[nodiscard]] bool is_udp_url(std::string_view url);
/// Reads `udp://HOST[:PORT]`; HOST is a name, an IPv4 address, or an IPv6 address in brackets.
[[nodiscard]] Result<UdpAddress> parse_udp_url(std::string_view url);

}  // namespace cairn::proto
