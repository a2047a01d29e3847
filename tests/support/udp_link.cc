#include "tests/support/udp_link.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>

#include "tests/support/cairn_programs.h"

namespace cairn::test {
namespace {

namespace fs = std::filesystem;

std::uint16_t free_udp_port() {
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  socklen_t size = sizeof address;
  bind(probe, reinterpret_cast<sockaddr*>(&address), size);
  getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size);
  close(probe);
  return ntohs(address.sin_port);
}

void append(const fs::path& file, const std::string& line) {
  std::ofstream(file, std::ios::app) << line;
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
}

}  // namespace

UdpLink::UdpLink(const TempFolder& folder, const std::vector<std::string>& robots, std::string host)
    : folder_(folder.path()), host_(std::move(host)), port_(free_udp_port()) {
  for (const std::string& robot : robots) {
    const std::string line = run({server_program(), "--new-key", robot}).output;
    append(folder_ / "robots.key", line);
    append(key_file(robot), line);
  }
}

std::string UdpLink::url() const { return "udp://" + host_ + ":" + std::to_string(port_); }

fs::path UdpLink::key_file(const std::string& robot) const { return folder_ / (robot + ".key"); }

std::vector<std::string> UdpLink::server_arguments() const {
  return {"--listen", url(), "--keys", (folder_ / "robots.key").string()};
}

std::vector<std::string> UdpLink::agent_arguments(const std::string& robot) const {
  return {"--server", url(), "--robot", robot, "--key", key_file(robot).string()};
}

}  // namespace cairn::test
