#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace cairn::test {

/// What a server and its robots need to meet over UDP: keys, and a port that is free now (a
/// restarted server takes it again).
class UdpLink {
 public:
  UdpLink(const TempFolder& folder, const std::vector<std::string>& robots,
          std::string host = "127.0.0.1");

  [[nodiscard]] std::string url() const;
  /// For cairn-server: listens on this link too.
  [[nodiscard]] std::vector<std::string> server_arguments() const;
  /// For cairn-agent.
  [[nodiscard]] std::vector<std::string> agent_arguments(const std::string& robot) const;

 private:
  [[nodiscard]] std::filesystem::path key_file(const std::string& robot) const;

  std::filesystem::path folder_;
  std::string host_;
  std::uint16_t port_;
};

}  // namespace cairn::test
