#include "proto/udp/endpoint.h"

#include <algorithm>
#include <charconv>

namespace cairn::proto {
namespace {

constexpr std::string_view kScheme = "udp://";
constexpr std::size_t kMaxHostBytes = 253;

Error bad_url(std::string_view why) {
  return {ErrorCode::invalid_argument,
          std::string(why) + ": write udp://HOST or udp://HOST:PORT, e.g. udp://base.local:8643"};
}

bool is_host_char(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
         c == '-' || c == '_' || c == ':';
}

Result<std::uint16_t> parse_port(std::string_view text) {
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, port);
  if (error != std::errc() || stop != end) return bad_url("a UDP port is a number up to 65535");
  return port;
}

}  // namespace

bool is_udp_url(std::string_view url) { return url.starts_with(kScheme); }

Result<UdpAddress> parse_udp_url(std::string_view url) {
  if (!is_udp_url(url)) return bad_url("a UDP address starts with udp://");
  url.remove_prefix(kScheme.size());
  const bool bracketed = url.starts_with('[');
  const std::size_t host_end = bracketed ? url.find(']') : url.find(':');
  if (bracketed && host_end == std::string_view::npos) return bad_url("the bracket is not closed");

  UdpAddress address;
  address.host = bracketed ? url.substr(1, host_end - 1) : url.substr(0, host_end);
  if (address.host.empty() || address.host.size() > kMaxHostBytes ||
      !std::ranges::all_of(address.host, is_host_char)) {
    return bad_url("a UDP address needs a host name or address");
  }
  const std::size_t rest = bracketed ? host_end + 1 : host_end;
  if (rest >= url.size()) return address;
  if (url[rest] != ':') return bad_url("only a port may follow the host");
  const auto port = parse_port(url.substr(rest + 1));
  if (!port) return port.error();
  address.port = *port;
  return address;
}

}  // namespace cairn::proto
