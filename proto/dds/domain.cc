#include "proto/dds/domain.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>

#include "proto/dds/log.h"

namespace cairn::proto {
namespace {

/// A UDP socket, closed at the end.
class UdpSocket {
 public:
  UdpSocket() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~UdpSocket() {
    if (fd_ >= 0) close(fd_);
  }
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

sockaddr* generic(sockaddr_in& address) { return reinterpret_cast<sockaddr*>(&address); }

std::string text_of(const in_addr& address) {
  char text[INET_ADDRSTRLEN] = {};
  inet_ntop(AF_INET, &address, text, sizeof text);
  return text;
}

Result<sockaddr_in> resolve(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (error != 0) {
    return Error{ErrorCode::unavailable, "host '" + host + "' of the DDS address is not known (" +
                                             gai_strerror(error) +
                                             "): check the name or give its IPv4 address"};
  }
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof address);
  freeaddrinfo(found);
  return address;
}

bool is_loopback(const sockaddr_in& address) { return ntohl(address.sin_addr.s_addr) >> 24 == 127; }

// The address of the interface through which the kernel reaches `server`; empty without a route. A
// robot often has more than one network, and only one leads to the base.
std::string interface_towards(sockaddr_in server, std::uint32_t domain) {
  server.sin_port = htons(dds_server_port(domain));
  const UdpSocket probe;
  sockaddr_in local{};
  socklen_t size = sizeof local;
  if (connect(probe.get(), generic(server), sizeof server) != 0 ||
      getsockname(probe.get(), generic(local), &size) != 0) {
    return "";
  }
  return text_of(local.sin_addr);
}

std::string interface_of(const sockaddr_in& address, DdsRole role, std::uint32_t domain) {
  if (is_loopback(address)) return "127.0.0.1";
  if (role == DdsRole::robot) return interface_towards(address, domain);
  return address.sin_addr.s_addr == INADDR_ANY ? "" : text_of(address.sin_addr);
}

bool server_port_taken(std::uint32_t domain) {
  const UdpSocket probe;
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_port = htons(dds_server_port(domain));
  return bind(probe.get(), generic(any), sizeof any) != 0 && errno == EADDRINUSE;
}

// Cyclone tells every failure by one code: find out which it was.
Error why_no_domain(dds_return_t code, const DdsEndpoint& endpoint, DdsRole role) {
  const std::string name = "DDS domain " + std::to_string(endpoint.domain);
  if (code == DDS_RETCODE_PRECONDITION_NOT_MET) {
    return {ErrorCode::conflict,
            name + " is already in use in this process: give each carrier its own domain"};
  }
  if (role == DdsRole::server && server_port_taken(endpoint.domain)) {
    return {ErrorCode::conflict, name + " is already served on this machine (UDP port " +
                                     std::to_string(dds_server_port(endpoint.domain)) +
                                     " is taken): stop the other cairn-server or DDS program, or "
                                     "choose another --domain"};
  }
  return {ErrorCode::io, "DDS cannot start for host '" + endpoint.host +
                             "': check that the address belongs to a network that is up (" +
                             last_dds_complaint() + ")"};
}

}  // namespace

Result<DdsParticipant> join_domain(const DdsEndpoint& endpoint, DdsRole role) {
  if (endpoint.domain > kMaxDdsDomain) {
    return Error{ErrorCode::invalid_argument, "a DDS domain is a number from 0 to 232"};
  }
  const auto address = resolve(endpoint.host);
  if (!address) return address.error();
  quiet_dds_log();
  const std::string xml =
      dds_config_xml({.role = role,
                      .interface_address = interface_of(*address, role, endpoint.domain),
                      .server_address = text_of(address->sin_addr),
                      .domain = endpoint.domain,
                      .loopback = is_loopback(*address)});
  const dds_entity_t created = dds_create_domain(endpoint.domain, xml.c_str());
  if (created < 0) return why_no_domain(created, endpoint, role);
  auto domain = DdsEntity::create(created, "domain");
  auto participant =
      DdsEntity::create(dds_create_participant(endpoint.domain, nullptr, nullptr), "participant");
  if (!participant) return participant.error();
  return DdsParticipant{std::move(domain).value(), std::move(participant).value()};
}

}  // namespace cairn::proto
