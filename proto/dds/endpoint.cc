#include "proto/dds/endpoint.h"

#include <algorithm>
#include <charconv>

namespace cairn::proto {
namespace {

constexpr std::string_view kScheme = "dds://";
constexpr std::string_view kDomainOption = "domain=";
constexpr std::size_t kMaxHostBytes = 253;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_lower(char c) { return c >= 'a' && c <= 'z'; }

bool is_host_char(char c) {
  return is_digit(c) || is_lower(c) || (c >= 'A' && c <= 'Z') || c == '.' || c == '-' || c == '_';
}

bool is_host(std::string_view host) {
  return !host.empty() && host.size() <= kMaxHostBytes && std::ranges::all_of(host, is_host_char);
}

Error bad_url(std::string_view why) {
  return {ErrorCode::invalid_argument, std::string(why) +
                                           ": write dds://HOST or "
                                           "dds://HOST?domain=N, e.g. dds://base.local?domain=7"};
}

Result<std::uint32_t> parse_domain(std::string_view text) {
  std::uint32_t domain = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, domain);
  if (error != std::errc() || stop != end || domain > kMaxDdsDomain) {
    return bad_url("a DDS domain is a number from 0 to 232");
  }
  return domain;
}

}  // namespace

Result<DdsEndpoint> parse_dds_url(std::string_view url) {
  if (!url.starts_with(kScheme)) return bad_url("a DDS address starts with dds://");
  url.remove_prefix(kScheme.size());
  const std::size_t question = url.find('?');
  DdsEndpoint endpoint{std::string(url.substr(0, question)), 0};
  if (endpoint.host.find(':') != std::string::npos) {
    return bad_url("a DDS address has no port (the domain decides it) and is IPv4 or a name");
  }
  if (!is_host(endpoint.host)) return bad_url("a DDS address needs a host name or IPv4 address");
  if (question == std::string_view::npos) return endpoint;

  std::string_view option = url.substr(question + 1);
  if (!option.starts_with(kDomainOption)) return bad_url("the only option is ?domain=N");
  option.remove_prefix(kDomainOption.size());
  const auto domain = parse_domain(option);
  if (!domain) return domain.error();
  endpoint.domain = *domain;
  return endpoint;
}

}  // namespace cairn::proto
