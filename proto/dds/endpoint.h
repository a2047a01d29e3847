#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/common/result.h"

namespace cairn::proto {

/// DDS domains above it have no UDP ports (7400 + 250 · domain must stay below 65536).
inline constexpr std::uint32_t kMaxDdsDomain = 232;

/// Where server and robots meet over DDS. A robot names the server's host; a server names the
/// address it listens on, `0.0.0.0` for the machine's main interface.
struct DdsEndpoint {
  std::string host;
  std::uint32_t domain = 0;  ///< [Limit: ≤ kMaxDdsDomain]
  friend bool operator==(const DdsEndpoint&, const DdsEndpoint&) = default;
};

/// Reads `dds://HOST[?domain=N]`; HOST is an IPv4 address or a host name.
[[nodiscard]] Result<DdsEndpoint> parse_dds_url(std::string_view url);

/// UDP port on which the server of a domain is first met (DDSI: PB + DG · domain + d1).
[[nodiscard]] constexpr std::uint16_t dds_server_port(std::uint32_t domain) {
  return static_cast<std::uint16_t>(7400 + 250 * domain + 10);
}

}  // namespace cairn::proto
